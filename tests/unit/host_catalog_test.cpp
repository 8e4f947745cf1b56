#include "host/catalog.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdio>
#include <set>
#include <thread>

#include "host/kinds.hpp"
#include "host_fixtures.hpp"

using namespace pelorus;
using namespace pelorus::host;
using namespace pelorus::host::test;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

Catalog catalog_of(const std::string& name) { return Catalog({fixture(name).parent_path()}); }

/// What load() says of that fixture's plugin.
std::string load_error(const std::string& name, const std::string& id) {
    Catalog catalog = catalog_of(name);
    return error_of([&] { catalog.load(id); });
}

/// What load() says, and that not even a static constructor of the library has run.
std::string load_error_before_any_code(const std::string& name, const std::string& id) {
    ::unsetenv("PELORUS_FIXTURE_LOADED");
    const std::string error = load_error(name, id);
    CHECK(::getenv("PELORUS_FIXTURE_LOADED") == nullptr);
    return error;
}

std::string reason_of(const Catalog& catalog, const fs::path& library) {
    for (const RejectedFile& rejected : catalog.rejected())
        if (rejected.library == library) return rejected.reason;
    return "not rejected";
}

std::string output_of(const std::string& command) {
    std::string text;
    FILE* pipe = ::popen(command.c_str(), "r");
    REQUIRE(pipe != nullptr);
    char buffer[256];
    while (std::fgets(buffer, sizeof buffer, pipe) != nullptr) text += buffer;
    ::pclose(pipe);
    return text;
}

}  // namespace

TEST_CASE("A plugin is found without being loaded, and loaded when asked for", "[host]") {
    ::unsetenv("PELORUS_FIXTURE_LOADED");
    const TemporaryFolder folder;  // a copy: other tests of this process may have loaded the fixture itself
    const fs::path library = folder.copy("good", "some/where/good.so");
    Catalog catalog({folder.path()});
    REQUIRE(catalog.plugins().size() == 1);
    CHECK(catalog.rejected().empty());
    CHECK(catalog.find("motion.good") == &catalog.plugins().front());
    CHECK(catalog.find("motion.goof") == nullptr);
    CHECK(catalog.find("") == nullptr);
    CHECK(::getenv("PELORUS_FIXTURE_LOADED") == nullptr);

    const LoadedPlugin& loaded = catalog.load("motion.good");
    CHECK(::getenv("PELORUS_FIXTURE_LOADED") == std::string("good"));
    CHECK(loaded.file.library == library);
    CHECK(loaded.description().id == std::string("motion.good"));
    CHECK(loaded.plugin->create != nullptr);
    CHECK(loaded.sha256() + "  " + library.string() + "\n" == output_of("sha256sum " + library.string()));
    CHECK(&catalog.load("motion.good") == &loaded);
}

TEST_CASE("A library is started once in a process, whoever loads it", "[host]") {
    ::unsetenv("PELORUS_FIXTURE_INITS");
    const TemporaryFolder folder;
    folder.copy("pair", "pair.so");
    const auto use = [&] {
        Catalog catalog({folder.path()});
        catalog.load("motion.pair");
        CHECK(catalog.load("motion.pair_second").description().version == std::string("0.2.0"));
    };
    use();
    std::thread other(use);
    other.join();
    CHECK(::getenv("PELORUS_FIXTURE_INITS") == std::string("1"));
}

TEST_CASE("Loading from many threads gives every one the same plugin", "[host]") {
    Catalog catalog = Catalog({fixture("good").parent_path(), fixture("pair").parent_path()});
    std::vector<const LoadedPlugin*> seen(8);
    std::vector<std::thread> threads;
    for (const LoadedPlugin*& result : seen) threads.emplace_back([&] { result = &catalog.load("motion.pair"); });
    for (std::thread& thread : threads) thread.join();
    CHECK(std::set<const LoadedPlugin*>(seen.begin(), seen.end()).size() == 1);
}

TEST_CASE("An unknown id is answered with what was searched and the nearest id", "[host]") {
    Catalog catalog = catalog_of("good");
    const std::string error = error_of([&] { catalog.load("motion.godo"); });
    const std::string more = "; more folders: --plugins DIR or PELORUS_PLUGIN_PATH";
    CHECK(error == "no plugin motion.godo (did you mean motion.good?); searched " +
                       fixture("good").parent_path().string() + more);
    CHECK(error_of([&] { catalog.load("good"); }) ==
          "no plugin good (did you mean motion.good?); searched " + fixture("good").parent_path().string() + more);
    Catalog empty({});
    CHECK(error_of([&] { empty.load("motion.good"); }) == "no plugin motion.good; searched no folder at all" + more);
    try {
        empty.load("motion.good");
    } catch (const Error& refused) {
        CHECK(refused.exit() == Exit::misuse);
    }
}

TEST_CASE("An id that has only a long beginning in common with another is not taken for it", "[host]") {
    Catalog catalog = catalog_of("spy");
    CHECK(error_of([&] { catalog.load("org.example.motion.drag"); }).find("did you mean") == std::string::npos);
    CHECK(error_of([&] { catalog.load("org.example.motion.spi"); }).find("(did you mean org.example.motion.spy?)") !=
          std::string::npos);
}

TEST_CASE("A guess is gone on with only where the name itself is near", "[host]") {
    Catalog catalog = catalog_of("good");
    const auto meant = [&](const std::string& id) {
        try {
            catalog.load(id);
        } catch (const UnknownPlugin& refused) {
            return refused.meant();
        }
        return std::string("found");
    };
    CHECK(meant("motion.goods") == "motion.good");
    CHECK(meant("good") == "motion.good");
    CHECK(meant("motion.flat").empty());
    CHECK(meant("org.example.motion.good").empty());
}

TEST_CASE("Another ABI or table is refused before any code of the plugin runs", "[host]") {
    const std::string abi = load_error_before_any_code("other_abi", "motion.other_abi");
    CHECK_THAT(abi, Contains("plugin motion.other_abi speaks ABI 99, this host " + std::to_string(PLR_ABI_MAJOR) +
                             ": rebuild it with the SDK of this host"));
    CHECK_THAT(abi, Contains(fixture("other_abi").string()));
    CHECK_THAT(load_error_before_any_code("other_table", "motion.other_table"),
               Contains("plugin motion.other_table speaks pelorus.motion.draft/1, this host " PLR_MOTION
                        ": rebuild it with the SDK of this host"));
    CHECK_THAT(load_error_before_any_code("unknown_kind", "motion.unknown_kind"),
               Contains("is of kind levitation, which this host does not know (it knows motion, sensor, "));
}

TEST_CASE("A library that is not what its manifest says is refused with the reason", "[host]") {
    CHECK_THAT(load_error("other_abi_in_entry", "motion.other_abi_in_entry"),
               Contains("its plr_entry speaks ABI 99, this host "));
    CHECK_THAT(load_error("factory_null", "motion.factory_null"),
               Contains("its factory does not know it (it answered NULL)"));
    CHECK_THAT(load_error("other_version", "motion.other_version"),
               Contains("the version of the loaded plugin is \"2.0.0\", its manifest says \"1.0.0\""));
    CHECK_THAT(load_error("doubled_parameter", "motion.doubled_parameter"),
               Contains("its description is wrong: parameter noise: its name is taken"));
    CHECK_THAT(load_error("no_entry", "motion.no_entry"), Contains("the library does not export plr_entry"));
    for (const char* name : {"other_abi_in_entry", "factory_null", "other_version", "doubled_parameter", "no_entry"}) {
        const std::string error = load_error(name, std::string("motion.") + name);
        CHECK_THAT(error, Contains("plugin motion." + std::string(name) + " (" + fixture(name).string() + "): "));
        CHECK(error.find('\n') == std::string::npos);
    }
}

TEST_CASE("What the loader says of a library reaches the message", "[host]") {
    const std::string error = load_error("undefined_symbol", "motion.undefined_symbol");
    CHECK_THAT(error, Contains("cannot be loaded"));
    CHECK_THAT(error, Contains("undefined symbol: pelorus_fixture_symbol_that_nobody_defines"));
    CHECK(error.find("Bad file descriptor") == std::string::npos);
}

TEST_CASE("A failed init is told once and for all, not tried again", "[host]") {
    ::unsetenv("PELORUS_FIXTURE_INITS");
    const std::string error = load_error("init_fails", "motion.init_fails");
    CHECK_THAT(error, Contains("its init failed: the licence server does not answer"));
    CHECK(load_error("init_fails", "motion.init_fails") == error);
    CHECK(::getenv("PELORUS_FIXTURE_INITS") == std::string("1"));
}

TEST_CASE("An exception out of a plugin's factory does not end the process", "[host]") {
    CHECK_THAT(load_error("throwing", "motion.throwing"), Contains("its factory failed: thrown by the factory"));
}

TEST_CASE("Two libraries with one id: the first is listed, loading names both", "[host]") {
    Catalog catalog({fixture("twin_b").parent_path(), fixture("twin_a").parent_path()});
    REQUIRE(catalog.plugins().size() == 1);
    CHECK(catalog.plugins().front().library == fixture("twin_b"));
    CHECK(reason_of(catalog, fixture("twin_a")) ==
          "its plugin motion.twin is in " + fixture("twin_b").string() + " as well");
    const std::string error = error_of([&] { catalog.load("motion.twin"); });
    CHECK_THAT(error, Contains("plugin motion.twin is in two libraries: " + fixture("twin_b").string() + " and " +
                               fixture("twin_a").string()));
}

TEST_CASE("The build tree's own build of an example gives way to another one", "[host]") {
    const TemporaryFolder folder;
    folder.copy("twin_a", "lib/pelorus/examples/twin/twin.so");
    const fs::path own = folder.path() / "lib/pelorus";
    Catalog alone({own});
    CHECK(error_of([&] { alone.load("motion.twin"); }).empty());
    Catalog catalog({fixture("twin_b").parent_path(), own});
    CHECK(catalog.load("motion.twin").file.library == fixture("twin_b"));
    CHECK_THAT(reason_of(catalog, fs::canonical(own / "examples/twin/twin.so")), Contains("as well"));
}

TEST_CASE("One library found by several ways is no clash", "[host]") {
    const TemporaryFolder folder;
    folder.copy("good", "real/good.so");
    fs::create_symlink(folder.path() / "real", folder.path() / "alias");
    fs::create_symlink(folder.path() / "real" / "good.so", folder.path() / "same.so");
    Catalog catalog(
        {folder.path() / "alias", folder.path(), folder.path() / "real", folder.path() / "alias" / ".." / "real"});
    CHECK(catalog.plugins().size() == 1);
    CHECK(catalog.rejected().empty());
    CHECK(error_of([&] { catalog.load("motion.good"); }).empty());
}

TEST_CASE("Subfolders are searched, symbolic loops end, other files are left alone", "[host]") {
    const TemporaryFolder folder;
    folder.copy("good", "a/b/c/good.so");
    folder.copy("good", "a/good.so.bak");
    fs::create_symlink(folder.path(), folder.path() / "a" / "b" / "up");
    fs::create_symlink(folder.path() / "y", folder.path() / "x");
    fs::create_symlink(folder.path() / "x", folder.path() / "y");
    fs::create_symlink(folder.path() / "nowhere.so", folder.path() / "dangling.so");
    folder.write("notes.so", "not a library");
    const Catalog catalog({folder.path(), folder.path() / "absent"});
    REQUIRE(catalog.plugins().size() == 1);
    CHECK(catalog.plugins().front().library == folder.path() / "a/b/c/good.so");
    CHECK(catalog.rejected().size() == 3);
    CHECK(reason_of(catalog, folder.path() / "notes.so") == "not a shared library (no ELF file)");
    CHECK_THAT(reason_of(catalog, folder.path() / "absent"), Contains("No such file"));
    CHECK_THAT(reason_of(catalog, folder.path() / "dangling.so"), Contains("No such file"));
}

TEST_CASE("What anyone may write or replace is not loaded", "[host]") {
    const TemporaryFolder folder;
    const fs::path library = folder.copy("good", "open/good.so");
    SECTION("a world-writable file") {
        fs::permissions(library, fs::perms::others_write, fs::perm_options::add);
        Catalog catalog({folder.path()});
        CHECK(catalog.plugins().empty());
        CHECK_THAT(reason_of(catalog, library), Contains("anyone may write this file"));
        CHECK_THAT(error_of([&] { catalog.load("motion.good"); }),
                   Contains("plugin motion.good (" + library.string() + ") is not used: anyone may write this file"));
    }
    SECTION("a file in a world-writable folder, found through a link from a safe one") {
        fs::permissions(library.parent_path(), fs::perms::others_write, fs::perm_options::add);
        fs::create_directory(folder.path() / "safe");
        fs::create_symlink(library, folder.path() / "safe" / "good.so");
        Catalog catalog({folder.path() / "safe"});
        CHECK(catalog.plugins().empty());
        CHECK_THAT(reason_of(catalog, library), Contains("anyone may replace files in its folder"));
    }
    SECTION("a sticky folder keeps others from replacing it") {
        fs::permissions(library.parent_path(), fs::perms::others_write | fs::perms::sticky_bit, fs::perm_options::add);
        CHECK(Catalog({folder.path()}).plugins().size() == 1);
    }
    SECTION("a file that became writable or was replaced after it was found") {
        Catalog catalog({folder.path()});
        fs::permissions(library, fs::perms::others_write, fs::perm_options::add);
        CHECK_THAT(error_of([&] { catalog.load("motion.good"); }), Contains("anyone may write this file"));
        fs::remove(library);
        folder.copy("other_table", "open/good.so");
        CHECK_THAT(error_of([&] { catalog.load("motion.good"); }), Contains("the file has changed since it was found"));
        fs::remove(library);
        CHECK_THAT(error_of([&] { catalog.load("motion.good"); }), Contains("cannot be examined"));
    }
}

TEST_CASE("A truncated library is rejected, never loaded", "[host]") {
    const TemporaryFolder folder;
    const std::string good = bytes_of(fixture("good"));
    const fs::path library = folder.write("cut.so", good.substr(0, good.size() / 2));
    Catalog catalog({folder.path()});
    CHECK(catalog.plugins().empty());
    CHECK_THAT(reason_of(catalog, library), Contains("truncated"));
}

TEST_CASE("The search path is the command line's, the environment's, then the installation's", "[host]") {
    const char* before = ::getenv("PELORUS_PLUGIN_PATH");
    const std::string saved = before == nullptr ? "" : before;
    ::setenv("PELORUS_PLUGIN_PATH", ":/opt/one::relative/two:", 1);
    const std::vector<fs::path> folders = Catalog::default_folders({"/first", "./second/../third", ""});
    if (before == nullptr)
        ::unsetenv("PELORUS_PLUGIN_PATH");
    else
        ::setenv("PELORUS_PLUGIN_PATH", saved.c_str(), 1);
    const fs::path executable = fs::read_symlink("/proc/self/exe");
    CHECK(folders == std::vector<fs::path>{"/first", fs::current_path() / "third", "/opt/one",
                                           fs::current_path() / "relative/two",
                                           executable.parent_path().parent_path() / "lib/pelorus"});
    for (const fs::path& folder : folders) CHECK(folder != fs::current_path());
}

TEST_CASE("At the end of the process libraries are ended, the last started first", "[host]") {
    const TemporaryFolder folder;
    folder.copy("good", "good.so");
    folder.copy("pair", "pair.so");
    const fs::path told = folder.path() / "told";
    std::fflush(nullptr);
    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        // exit() also ends libraries that other tests loaded: they must not write.
        std::freopen((folder.path() / "log").c_str(), "w", stderr);
        ::setenv("PELORUS_FIXTURE_DEINIT_FILE", told.c_str(), 1);
        Catalog catalog({folder.path()});
        catalog.load("motion.good");
        catalog.load("motion.pair");
        std::exit(0);
    }
    int status = 0;
    REQUIRE(::waitpid(child, &status, 0) == child);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 0);
    CHECK(bytes_of(told).substr(0, 10) == "pair good ");
    CHECK_THAT(bytes_of(folder.path() / "log"), Contains("[pair.so] deinit was here"));
}

TEST_CASE("Every kind is there once, and speaks a table of this SDK", "[host]") {
    std::set<std::string> names;
    for (const Kind& kind : kinds) {
        CHECK(names.insert(kind.name).second);
        CHECK(find_kind(kind.name) == &kind);
        CHECK(kind.is_stage == (std::string(kind.table_id) == PLR_STAGE));
    }
    CHECK(names == std::set<std::string>{"motion", "sensor", "estimator", "extent", "partitioner", "waveform",
                                         "trajectory", "source", "registration", "fusion", "tracker", "scheduler",
                                         "analyzer", "sink"});
    CHECK(find_kind("stage") == nullptr);
}
