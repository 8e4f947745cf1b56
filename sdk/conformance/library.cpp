// What every library promises: its file, and what loading it does. What its entry point answers: library_entry.cpp.
#include <cxxabi.h>
#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <memory>

#include <fmt/format.h>

#include "machine/apart.hpp"
#include "machine/bench.hpp"
#include "machine/elf.hpp"
#include "machine/process_state.hpp"

namespace pelorus::conformance {

namespace {

/// The name as the source has it, cut where templates make it long.
std::string demangled(const std::string& name) {
    constexpr std::size_t most = 60;
    int status = 0;
    const std::unique_ptr<char, decltype(&std::free)> source(
        abi::__cxa_demangle(name.c_str(), nullptr, nullptr, &status), &std::free);
    const std::string text = source != nullptr ? source.get() : name;
    return text.size() <= most ? text : text.substr(0, most) + "...";
}

}  // namespace

PELORUS_CHECK(
    library, "library-manifest-readable", 1,
    "The ELF section `pelorus` names every plugin of the library in a form that can be read without loading it; a "
    "host that looks for one plugin opens no other library.",
    {}) {
    for (const ManifestEntry& entry : bench.host().manifests(bench.task().library))
        if (entry.kind.empty() || entry.version.empty()) FAIL(entry.id << ": its manifest says no kind or no version");
}

PELORUS_CHECK(
    library, "library-stack-not-executable", 1,
    "The library needs no executable stack; with one, an overflow anywhere in the process becomes a way in, and newer "
    "loaders refuse the library.",
    {}) {
    if (read_elf(bench.task().library).has_executable_stack)
        FAIL(
            "its PT_GNU_STACK segment is executable or missing: link with -Wl,-z,noexecstack, and give assembly "
            "sources a section .note.GNU-stack");
}

PELORUS_CHECK(
    library, "library-search-path-is-absolute", 1,
    "What the library is linked to is never looked for in the working directory; whoever can write there would run "
    "code in the host.",
    {}) {
    for (const std::string& folder : read_elf(bench.task().library).search_path)
        if (folder.empty() || (folder.front() != '/' && folder.rfind("$ORIGIN", 0) != 0))
            FAIL_CHECK("its search path (RPATH, RUNPATH) has the entry `"
                       << folder << "`, which is relative to the working directory: begin it with / or $ORIGIN");
}

PELORUS_CHECK(library, "library-exports-one-symbol", 1,
              "The library exports " PLR_ENTRY_SYMBOL
              " and nothing else; any other symbol may stand in for one of the host's or of another "
              "plugin's, which then crashes far from here.",
              {}) {
    std::vector<std::string> others = read_elf(bench.task().library).exported;
    others.erase(std::remove(others.begin(), others.end(), PLR_ENTRY_SYMBOL), others.end());
    constexpr std::size_t shown = 2;
    if (others.empty()) return;
    const std::size_t count = others.size();
    if (count > shown) others.resize(shown);
    for (std::string& name : others) name = demangled(name);
    FAIL(
        fmt::format("it also exports {} {} ({}{}); build it with pelorus_add_plugin, or compile with "
                    "-fvisibility=hidden and link with a version script (`{{ global: plr_entry; local: *; }};`)",
                    count, count == 1 ? "symbol" : "symbols", fmt::join(others, ", "), count > shown ? ", ..." : ""));
}

PELORUS_CHECK(
    library, "library-symbols-resolved", 1,
    "Every symbol that the library uses is defined by it or by what it is linked to; otherwise it loads on the "
    "machine that built it, perhaps, and on no other.",
    {"library-stack-not-executable"}) {
    const std::string& path = bench.task().library;
    if (dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL) != nullptr) return;
    const std::string loader = dlerror();
    if (loader.find("undefined symbol") == std::string::npos) return;  // library-loads tells the rest
    void* const handle = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
    std::vector<std::string> missing;
    if (handle != nullptr)
        for (const std::string& name : read_elf(path).needed)
            if (dlsym(handle, name.c_str()) == nullptr && dlsym(RTLD_DEFAULT, name.c_str()) == nullptr)
                missing.push_back(name);
    if (missing.empty()) FAIL("the loader says: " << loader << "; link with -Wl,-z,defs, which tells all of them");
    FAIL(fmt::format("undefined: {}; link with -Wl,-z,defs and with the libraries that have them",
                     fmt::join(missing, ", ")));
}

PELORUS_CHECK(
    library, "library-loads", 1,
    "The library loads with RTLD_NOW | RTLD_LOCAL and its entry point is of this ABI; a host does nothing else "
    "with a library that does not.",
    {"library-symbols-resolved"}) {
    bench.library();
}

PELORUS_CHECK(
    library, "library-loads-silently", 2,
    "Loading runs no code that could be noticed: nothing is printed, no thread is started. A host loads libraries "
    "only to look at them, before it knows whether they fit.",
    {"library-loads"}) {
    const std::size_t threads = thread_count(), written = bytes_written_to_terminal();
    const std::size_t files = open_file_count();
    REQUIRE(dlopen(bench.task().library.c_str(), RTLD_NOW | RTLD_LOCAL) != nullptr);
    const std::size_t more_threads = thread_count() - threads, more_written = bytes_written_to_terminal() - written;
    if (more_written != 0)
        FAIL_CHECK("a static constructor wrote " << more_written << " bytes to standard output or standard error");
    if (more_threads != 0) FAIL_CHECK("a static constructor started " << more_threads << " threads");
    if (open_file_count() > files) FAIL_CHECK("a static constructor left a file or socket open");
}

PELORUS_CHECK(
    library, "library-keeps-process-settings", 2,
    "Loading and starting the library changes nothing that belongs to the whole process: floating-point modes, signal "
    "handlers, locale, folder, environment. All other plugins live with it too.",
    {"library-loads"}) {
    const std::vector<Setting> before = process_settings();
    bench.library();
    const std::vector<Setting> after = process_settings();
    for (std::size_t i = 0; i < before.size(); ++i)
        if (before[i].value != after[i].value)
            FAIL_CHECK(before[i].name << ": " << before[i].value << " before, " << after[i].value
                                      << " after the library was loaded");
}

PELORUS_CHECK(library, "library-ends-well", 2,
              "After init, some work and deinit the process ends: no thread of the library is left, and nothing that "
              "is torn down at exit crashes. A run whose end crashes has lost its results for whoever looks at the "
              "exit code.",
              {"library-answers-its-plugins"}) {
    const std::size_t threads = thread_count();
    const Apart ended = apart([&]() -> std::string {
        const Library& library = bench.library();
        for (const ManifestEntry& entry : bench.host().manifests(library.path())) {
            const plr_plugin* const plugin = library.entry().factory(entry.id.c_str());
            if (plugin == nullptr || plugin->create == nullptr) continue;  // other checks tell that
            try {
                Instance(bench.host(), *plugin, Node(), Surroundings());
            } catch (const std::exception&) {
                // It needs values or parts; other checks have them.
            }
        }
        if (library.entry().deinit != nullptr) library.entry().deinit();
        const std::size_t left = thread_count();
        if (left > threads) return fmt::format("{} of its threads still run after deinit", left - threads);
        std::exit(0);  // with the destructors of static objects
    });
    if (!ended.problem.empty()) FAIL("init, work, deinit, exit: " << ended.problem);
    if (!ended.written.empty()) FAIL(ended.written);
}

}  // namespace pelorus::conformance
