/// What a shared library's file says of itself: read without loading it.
#pragma once

#include <string>
#include <vector>

namespace pelorus::conformance {

struct ElfFacts {
    std::vector<std::string> exported;  ///< symbols that others can link to
    std::vector<std::string> needed;    ///< symbols that others must have; weak ones may be missing and are not told
    std::vector<std::string>
        search_path;  ///< folders in which the loader looks for its libraries, `$ORIGIN` unexpanded
    bool has_executable_stack = false;
};

/// Throws Refused if it is no 64-bit ELF file or lies beyond its own end.
ElfFacts read_elf(const std::string& path);

}  // namespace pelorus::conformance
