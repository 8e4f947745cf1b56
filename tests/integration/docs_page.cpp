#include "docs_page.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>

#include "../fixtures/temporary_folder.hpp"
#include "../support/line_match.hpp"
#include "../support/markdown.hpp"
#include "../support/process.hpp"
#include "docs_fragment.hpp"

namespace pelorus::test {

namespace fs = std::filesystem;

namespace {

using Lines = std::vector<std::string>;

/// `...` stands for any text.
bool line_matches(const std::string& expected, const std::string& printed) {
    return pelorus::test::line_matches(expected, printed, "...");
}

bool lines_match(const Lines& expected, std::size_t i, const Lines& printed, std::size_t j) {
    if (i == expected.size()) return j == printed.size();
    if (trimmed(expected[i]) == "...") {
        for (; j <= printed.size(); ++j)
            if (lines_match(expected, i + 1, printed, j)) return true;
        return false;
    }
    return j < printed.size() && line_matches(expected[i], printed[j]) && lines_match(expected, i + 1, printed, j + 1);
}

Lines without_trailing_blanks(Lines lines) {
    for (std::string& line : lines) line.erase(line.find_last_not_of(" \t\r") + 1);
    while (!lines.empty() && lines.back().empty()) lines.pop_back();
    return lines;
}

std::string indented(const Lines& lines) {
    std::string text;
    for (const std::string& line : lines) text += "    " + line + "\n";
    return text;
}

/// A command of a `console` block and what it is said to print.
struct Command {
    int line = 0;
    std::string text;
    Lines output;
};

std::vector<Command> commands_of(const CodeBlock& block) {
    std::vector<Command> commands;
    bool continued = false;
    int number = block.line;
    for (const std::string& line : block.lines) {
        ++number;
        if (line.rfind("$ ", 0) == 0) {
            commands.push_back({number, line.substr(2), {}});
            continued = true;
        } else if (commands.empty()) {
            throw std::runtime_error("a console block begins with a line `$ command`");
        } else if (continued && line.rfind("> ", 0) == 0) {
            commands.back().text += "\n" + line.substr(2);
        } else {
            commands.back().output.push_back(line);
            continued = false;
        }
    }
    return commands;
}

/// The lines of an excerpt or of one side of a change, as they must stand in a file: from where to where.
std::size_t places_of(const std::string& part, const std::string& text, std::size_t& first) {
    std::size_t places = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
        if (at != 0 && text[at - 1] != '\n') continue;
        if (places++ == 0) first = at;
    }
    return places;
}

/// `--out`, `--set`, ... wherever they stand, or only where a line of help explains them.
std::set<std::string> flags_in(const std::string& text, const std::regex& form) {
    std::set<std::string> flags;
    for (std::sregex_iterator flag(text.begin(), text.end(), form), end; flag != end; ++flag) flags.insert((*flag)[1]);
    return flags;
}

/// A reader's home: a fresh folder with the tree in it, and a shell whose folder and variables last from command to command.
class Reader {
public:
    explicit Reader(const fs::path& home) : home_(home) {
        fs::remove_all(home_);
        fs::create_directories(home_);
        copy_tree();
        std::ofstream(state_.path() / "folder") << home_.string() << "\n";
        std::ofstream(state_.path() / "variables");
    }

    /// Output and errors come together in `out`, in the order in which a terminal would show them.
    Ended shell(const std::string& command) const {
        static const std::string script =
            ". \"$0/variables\"; cd \"$(<\"$0/folder\")\" || exit 125\n"
            "{ . \"$0/command\"; } 2>&1; status=$?; export -p >\"$0/variables\"; pwd >\"$0/folder\"; exit $status\n";
        std::ofstream(state_.path() / "command") << command << "\n";
        ProcessOptions options;
        options.environment = environment();
        return run({"bash", "-c", script, state_.path().string()}, options);
    }

    fs::path folder() const { return trimmed(read_file(state_.path() / "folder")); }

    /// A file that a page names: relative to the shell's folder, else to the tree.
    fs::path find(const std::string& name) const {
        for (const fs::path& base : {folder(), home_ / "pelorus"})
            if (fs::exists(base / name)) return base / name;
        throw std::runtime_error("no file " + name + ", neither in " + folder().string() + " nor in the tree");
    }

private:
    /// A copy, so that what a page builds or runs in the tree stays out of the sources; but the build is the one under test, and
    /// folders in which no page has any business are links.
    void copy_tree() const {
        const fs::path tree = home_ / "pelorus";
        fs::create_directories(tree / "build");
        std::vector<std::string> copy = {"cp", "-a"};
        for (const fs::directory_entry& entry : fs::directory_iterator(PELORUS_SOURCE_DIR)) {
            const std::string name = entry.path().filename().string();
            if (name == "framework" || name == "tests" || name == "bench")
                fs::create_directory_symlink(entry.path(), tree / name);
            else if (name != "build" && name != "results" && name != ".git" && name != ".cache")
                copy.push_back(entry.path().string());
        }
        copy.push_back(tree.string());
        if (run(copy).exit != 0) throw std::runtime_error("cannot copy the tree to " + tree.string());
        fs::create_directory_symlink(PELORUS_BUILD_DIR, tree / "build" / "release");
    }

    std::map<std::string, std::string> environment() const {
        const char* path = std::getenv("PATH");
        const char* home = std::getenv("HOME");
        std::map<std::string, std::string> variables = {
            {"HOME", home_.string()},    {"PATH", std::string(PELORUS_BUILD_DIR "/bin:") + path},
            {"PELORUS_PLUGIN_PATH", ""}, {"PELORUS_DATA", ""},
            {"CMAKE_PREFIX_PATH", ""},   {"CMAKE_BUILD_PARALLEL_LEVEL", "2"}};
        // Compilers' results may be kept: the same as a reader's, sooner.
        if (std::getenv("CCACHE_DIR") == nullptr && home != nullptr)
            variables["CCACHE_DIR"] = std::string(home) + "/.cache/ccache";
        if (run({"sh", "-c", "command -v ccache"}).exit == 0)
            variables["CMAKE_CXX_COMPILER_LAUNCHER"] = variables["CMAKE_C_COMPILER_LAUNCHER"] = "ccache";
        return variables;
    }

    fs::path home_;
    TemporaryFolder state_;  ///< what lasts from one command to the next
};

class Execution {
public:
    Execution(const std::string& page, const Reader& reader, std::vector<std::string>& failures)
        : page_(page), reader_(reader), failures_(failures) {}

    void execute() {
        const MarkdownPage page = read_markdown(fs::path(PELORUS_SOURCE_DIR) / page_);
        for (const std::string& directive : page.directives) follow(directive);
        for (const CodeBlock& block : page.blocks) try {
                execute(block);
            } catch (const std::exception& problem) {
                fail(block.line, problem.what());
            }
    }

private:
    void fail(int line, const std::string& what) {
        failures_.push_back(page_ + ":" + std::to_string(line) + ": " + what);
    }

    void follow(const std::string& directive) {
        if (directive.rfind("in ", 0) == 0) {
            reader_.shell("cd " + directive.substr(3));
        } else if (directive.rfind("after ", 0) == 0) {
            const fs::path before = fs::path(page_).parent_path() / directive.substr(6);
            Execution(before.string(), reader_, failures_).execute();
            reader_.shell("cd");
        } else {
            fail(1, "unknown directive '" + directive + "'; there are: in FOLDER, after PAGE");
        }
    }

    void execute(const CodeBlock& block) {
        if (!block.fenced && block.lines.front().rfind("pelorus ", 0) == 0) return synopsis(block);
        if (!block.fenced)
            return fail(
                block.line,
                "an indented block that is no synopsis of a command: fence it, and say what it is: ```console, ```yaml "
                "file=NAME, ```text, ... (see docs/writing-docs.md)");
        static const std::set<std::string> known = {"file",     "from",   "into",    "at",
                                                    "fragment", "broken", "plugins", "exit"};
        for (const auto& mark : block.marks)
            if (known.count(mark.first) == 0) return fail(block.line, "unknown mark '" + mark.first + "'");
        if (block.language == "text" && block.marks.empty()) return;
        if (block.language == "console") return console(block);
        if (block.has("from")) return excerpt(block);
        if (block.language == "diff" && block.has("file")) return change(block);
        if (block.has("file")) return write(block);
        if (block.language == "yaml" && block.has("into")) return into(block);
        if (block.language == "yaml" && block.has("fragment")) return fragment(block);
        fail(block.line, "nothing tells what to do with this block (```" + block.language +
                             "): add file=NAME, from=FILE, for yaml into=CONFIG at=ADDRESS or fragment; or make it "
                             "console or text (see docs/writing-docs.md)");
    }

    /// `pelorus COMMAND ...` with its flags, indented: the command's help has the same ones.
    void synopsis(const CodeBlock& block) {
        std::istringstream words(block.text());
        std::string command;
        words >> command >> command;
        static const std::regex anywhere("[ \\[(](--[a-z][a-z-]*)"), explained("\\n  (?:-[a-z], )?(--[a-z][a-z-]*)");
        const Ended help = reader_.shell("pelorus help " + command);
        const std::set<std::string> known = flags_in(help.out, explained), told = flags_in(block.text(), anywhere);
        if (help.exit != 0) fail(block.line, "`pelorus help " + command + "` exits with " + std::to_string(help.exit));
        for (const std::string& flag : told)
            if (known.count(flag) == 0) fail(block.line, "`pelorus help " + command + "` knows no " + flag);
        for (const std::string& flag : known)
            if (told.count(flag) == 0 && flag != "--help")
                fail(block.line, "`pelorus help " + command + "` has " + flag + ", which is missing here");
    }

    void console(const CodeBlock& block) {
        const std::vector<Command> commands = commands_of(block);
        for (const Command& command : commands) {
            const bool last = &command == &commands.back();
            const int wanted = last && block.has("exit") ? std::stoi(block.marks.at("exit")) : 0;
            const Ended ended = reader_.shell(command.text);
            const Lines expected = without_trailing_blanks(command.output);
            const Lines printed = without_trailing_blanks(lines_of(ended.out));
            if (ended.exit != wanted)
                fail(command.line, "`" + command.text + "` exits with " + std::to_string(ended.exit) + ", expected " +
                                       std::to_string(wanted) + "; it printed\n" + indented(printed));
            else if (!matches(expected, printed))
                fail(command.line, difference(command.text, expected, printed));
        }
    }

    static std::string difference(const std::string& command, const Lines& expected, const Lines& printed) {
        std::size_t same = 0;
        while (same < expected.size() && same < printed.size() && line_matches(expected[same], printed[same])) ++same;
        std::string text = "`" + command + "` prints something else than the page says, from line " +
                           std::to_string(same + 1) + " of its output on\n";
        if (same < expected.size()) text += "  - " + expected[same] + "\n";
        if (same < printed.size()) text += "  + " + printed[same] + "\n";
        return text + "  it printed\n" + indented(printed);
    }

    void write(const CodeBlock& block) {
        const fs::path file = reader_.folder() / block.marks.at("file");
        fs::create_directories(file.parent_path());
        std::ofstream(file) << block.text();
        if (block.language == "yaml") check(block, file);
    }

    /// A config must be good, one that is marked `broken` must not be.
    void check(const CodeBlock& block, fs::path file) {
        // Expected figures are checked with the config that they belong to.
        if (file.stem().extension() == ".expected") file.replace_filename(file.stem().stem().string() + ".yaml");
        const std::string flags = block.has("plugins") ? " --plugins " + block.marks.at("plugins") : "";
        const Ended ended = reader_.shell("pelorus check '" + file.string() + "'" + flags);
        if (block.has("broken") && ended.exit == 0)
            fail(block.line, "is marked `broken`, and pelorus check finds it good");
        if (!block.has("broken") && ended.exit != 0)
            fail(block.line, "pelorus check refuses it:\n" + indented(lines_of(ended.out)));
    }

    void into(const CodeBlock& block) {
        const fs::path base = reader_.find(block.marks.at("into"));
        const std::string address = block.has("at") ? block.marks.at("at") : "";
        const fs::path merged = base.parent_path() / "merged-fragment.yaml";
        std::ofstream(merged) << merge_fragment(read_file(base), address, block.text());
        check(block, merged);
        fs::remove(merged);
    }

    void fragment(const CodeBlock& block) {
        if (!YAML::Load(block.text()).IsMap()) fail(block.line, "a fragment is a map");
    }

    /// Lines with `...` alone stand for gaps; each stretch between them must stand in the file, in this order.
    void excerpt(const CodeBlock& block) {
        const std::string text = read_file(reader_.find(block.marks.at("from")));
        Lines expected = {"..."};
        expected.insert(expected.end(), block.lines.begin(), block.lines.end());
        expected.emplace_back("...");
        if (!matches(without_trailing_blanks(expected), without_trailing_blanks(lines_of(text))))
            fail(block.line, block.marks.at("from") + " does not have these lines; it is\n" + indented(lines_of(text)));
    }

    /// Lines with `-` become those with `+`; the others, which begin with a blank, say where.
    void change(const CodeBlock& block) {
        std::string before, after;
        for (const std::string& line : block.lines) {
            const char side = line.empty() ? ' ' : line.front();
            const std::string rest = line.empty() ? "" : line.substr(1);
            if (side != '+') before += rest + "\n";
            if (side != '-') after += rest + "\n";
        }
        const fs::path file = reader_.find(block.marks.at("file"));
        std::string text = read_file(file);
        std::size_t at = 0;
        const std::size_t places = places_of(before, text, at);
        if (places != 1)
            return fail(block.line, "the lines to be changed stand in " + block.marks.at("file") + " " +
                                        std::to_string(places) + " times, expected once; the file is\n" +
                                        indented(lines_of(text)));
        std::ofstream(file) << text.replace(at, before.size(), after);
        if (file.extension() == ".yaml") check(block, file);
    }

    std::string page_;
    const Reader& reader_;
    std::vector<std::string>& failures_;
};

}  // namespace

bool matches(const std::vector<std::string>& expected, const std::vector<std::string>& printed) {
    return lines_match(expected, 0, printed, 0);
}

std::vector<std::string> documented_pages() {
    const fs::path tree = PELORUS_SOURCE_DIR;
    std::vector<std::string> pages = {"README.md"};
    for (const fs::directory_entry& entry : fs::directory_iterator(tree / "docs"))
        if (entry.path().extension() == ".md") pages.push_back("docs/" + entry.path().filename().string());
    for (const char* folder : {"plugins", "sdk/examples"})
        for (const fs::directory_entry& entry : fs::recursive_directory_iterator(tree / folder))
            if (entry.path().filename() == "README.md") pages.push_back(fs::relative(entry.path(), tree).string());
    std::sort(pages.begin(), pages.end());
    return pages;
}

std::vector<std::string> execute_page(const std::string& page) {
    std::string name = fs::path(page).is_absolute() ? fs::path(page).filename().string() : page;
    std::replace(name.begin(), name.end(), '/', '-');
    const Reader reader(fs::path(PELORUS_BUILD_DIR) / "tests" / "docs" / name);
    std::vector<std::string> failures;
    Execution(page, reader, failures).execute();
    return failures;
}

}  // namespace pelorus::test
