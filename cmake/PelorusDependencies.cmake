# Every library that the host or a plugin of this tree may link, by the name to link it with.

find_package(Threads REQUIRED)              # Threads::Threads
find_package(Eigen3 3.4 REQUIRED NO_MODULE) # Eigen3::Eigen (comes with PelorusSDK::sdk)
# Boost::headers has Boost.DLL. NO_MODULE: the config files tell versions apart, the old find module mixes them up.
find_package(Boost 1.81 REQUIRED NO_MODULE COMPONENTS headers filesystem program_options iostreams)
find_package(fmt 9 REQUIRED)                # fmt::fmt
find_package(spdlog 1.10 REQUIRED)          # spdlog::spdlog, the compiled one
find_package(yaml-cpp 0.7 REQUIRED)         # yaml-cpp
find_package(nlohmann_json 3.11 REQUIRED)   # nlohmann_json::nlohmann_json
find_package(ZLIB REQUIRED)                 # ZLIB::ZLIB
find_package(Catch2 2.13 REQUIRED)          # Catch2::Catch2, version 2: <catch2/catch.hpp>

# Debian ships these two with pkg-config files, but with no CMake package worth the name.
find_package(PkgConfig REQUIRED)
pkg_check_modules(geographiclib REQUIRED IMPORTED_TARGET geographiclib>=2.1) # PkgConfig::geographiclib
pkg_check_modules(libsodium REQUIRED IMPORTED_TARGET libsodium)              # PkgConfig::libsodium
