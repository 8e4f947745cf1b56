#include "support.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <regex>

#include <pelorus/abi/threads.h>

namespace pelorus::test {

namespace fs = std::filesystem;

namespace {

void write(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

/// Argument, descriptor and element structs tell their size; what holds functions is a table, and never grows.
bool may_grow(const std::string& body) {
    return body.find("uint32_t struct_size;") != std::string::npos && body.find("(*") == std::string::npos;
}

std::string grown(const std::string& header) {
    static const std::regex structs(R"(typedef struct (plr_\w+) \{([^]*?)\n\} \1;)");
    std::string text;
    auto rest = header.cbegin();
    for (std::sregex_iterator at(header.begin(), header.end(), structs), end; at != end; ++at) {
        const std::smatch& found = *at;
        text.append(rest, found[2].second);
        if (may_grow(found[2].str())) text += "\n  double grown[3]; /* unknown to older ones */";
        rest = found[2].second;
    }
    return text.append(rest, header.cend());
}

}  // namespace

Ended abi(const std::string& command, const std::string& headers, const std::string& baseline,
          const std::string& compiler) {
    ProcessOptions options;
    options.environment["CC"] = compiler;
    return run(
        {"python3", PELORUS_SOURCE_DIR "/tests/abi/abi.py", command, "--headers", headers, "--baseline", baseline},
        options);
}

std::string write_newer_headers(const TemporaryFolder& folder) {
    const fs::path abi = folder.path() / "newer/pelorus/abi";
    fs::create_directories(abi);
    for (const fs::directory_entry& entry : fs::directory_iterator(today + "/pelorus/abi"))
        if (entry.path().extension() == ".h") write(abi / entry.path().filename(), grown(read_file(entry.path())));
    fs::remove(abi / "layout.h");  // states today's sizes
    replace_in((abi / "abi.h").string(), "#include \"layout.h\"\n", "");
    const std::string minor = "#define PLR_ABI_MINOR ";
    replace_in((abi / "threads.h").string(), minor + std::to_string(PLR_ABI_MINOR),
               minor + std::to_string(PLR_ABI_MINOR + 1));
    return folder / "newer";
}

void compile(const std::string& headers, const std::string& source, const std::string& out,
             const std::vector<std::string>& flags) {
    // Initializers that leave members out are how a source stays good for newer headers.
    std::vector<std::string> words = {
        "cc", "-std=c11", "-pedantic", "-Wall", "-Wextra", "-Wno-missing-field-initializers", "-Werror", "-O1",
        "-I", headers,    source,      "-o",    out};
    words.insert(words.end(), flags.begin(), flags.end());
    const Ended built = run(words);
    CAPTURE(words, built.err);
    REQUIRE(built.exit == 0);
}

void compile_plugin(const std::string& headers, const std::string& source, const std::string& out) {
    compile(headers, source, out, {"-shared", "-fPIC", "-fvisibility=hidden", "-Wl,-z,defs", "-lm"});
}

void replace_in(const std::string& file, const std::string& from, const std::string& to) {
    std::string text = read_file(file);
    CAPTURE(file, from);
    REQUIRE(count(text, from) == 1);
    text.replace(text.find(from), from.size(), to);
    write(file, text);
}

}  // namespace pelorus::test
