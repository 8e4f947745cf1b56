// pelorus-conform: the conformance suites, in an executable of their own, because they watch what plugins ask of the C library by
// standing before it. `pelorus conform` starts it.
#include <cstdlib>
#include <fstream>

#include "cli/config_flags.hpp"
#include "cli/conform_grammar.hpp"
#include "cli/interrupt.hpp"
#include "cli/output.hpp"
#include "conform/suite_host.hpp"
#include "conformance/machine/runner.hpp"
#include "graph/problems.hpp"
#include "host/kinds.hpp"
#include "host/search.hpp"

namespace {

using namespace pelorus;
using conformance::Options;

constexpr std::uint64_t deepest_level = 5, most_jobs = 256, longest_limit = 3600;

void check_library(const std::string& name, const std::filesystem::path& file) {
    std::error_code ignored;
    const auto refuse = [&](const std::string& why) {
        throw Error(Exit::misuse, (name.empty() ? "''" : name) + ": " + why);
    };
    if (!std::filesystem::exists(file, ignored)) refuse("there is no such file");
    if (std::filesystem::is_directory(file, ignored)) refuse("is a folder, expected a shared library");
    if (!std::filesystem::is_regular_file(file, ignored)) refuse("is no regular file, expected a shared library");
    const std::string danger = host::why_unsafe(file);
    if (!danger.empty()) refuse(danger);
}

/// Before anything is tried: a report that cannot be kept is no use afterwards.
void check_writable(const std::filesystem::path& file) {
    if (file.empty() || file == "-") return;
    std::error_code ignored;
    const bool was_there = std::filesystem::exists(file, ignored);
    if (!std::ofstream(file, std::ios::app)) throw Error(Exit::misuse, file.string() + ": cannot be written");
    if (!was_there) std::filesystem::remove(file, ignored);
}

std::vector<std::string> kind_names() {
    std::vector<std::string> names;
    for (const host::Kind& kind : host::kinds) names.emplace_back(kind.name);
    return names;
}

std::vector<std::string> check_names() {
    std::vector<std::string> names;
    for (const conformance::Check& check : conformance::checks()) names.emplace_back(check.name);
    return names;
}

Options read_options(const cli::CommandLine& line) {
    Options options;
    std::error_code ignored;
    options.library = std::filesystem::absolute(line.argument(0), ignored);
    check_library(line.argument(0), options.library);
    options.kinds = line.values("kind");
    for (const std::string& kind : options.kinds)
        if (host::find_kind(kind) == nullptr)
            throw Error(Exit::misuse,
                        "--kind: there is no kind " + kind + graph::suggestion(kind, kind_names(), "kinds"));
    options.only = line.values("only");
    for (const std::string& name : options.only)
        if (conformance::find_check(name) == nullptr)
            throw Error(Exit::misuse, "--only: there is no check " + name +
                                          graph::suggestion(name, check_names(), "checks") +
                                          "; `pelorus conform --list` tells all");
    options.level = static_cast<int>(line.number("level", 3, deepest_level, 1));
    options.seed = line.number("seed", 1, UINT64_MAX);
    options.jobs = static_cast<unsigned>(line.number("jobs", 0, most_jobs, 1));
    options.time_limit = static_cast<double>(line.number("time-limit", 20, longest_limit, 1));
    options.is_quiet = line.has("quiet");
    options.json = line.value("json");
    options.junit = line.value("junit");
    if (options.json == "-" && options.junit == "-")
        throw Error(Exit::misuse, "--json and --junit: only one of them can go to standard output");
    check_writable(options.json);
    check_writable(options.junit);
    if (line.has("subjects")) options.subjects = std::filesystem::absolute(line.value("subjects"), ignored);
    for (const char* flag : {"kind", "seed", "subjects", "plugins", "time-limit"})
        for (const std::string& value : line.values(flag)) {
            options.repeat.push_back(std::string("--") + flag);
            options.repeat.push_back(value);
        }
    return options;
}

void write_to(const std::filesystem::path& file, const std::string& text) {
    if (file.empty()) return;
    if (file == "-") return cli::print(text);
    std::ofstream stream(file, std::ios::binary);
    stream << text;
    stream.close();
    if (!stream) throw Error(Exit::run_failed, file.string() + ": cannot be written");
}

/// Tells what an earlier report says of the checks that are asked for.
int answer_from_report(const cli::CommandLine& line) {
    const std::string file = line.value("from");
    std::ifstream stream(file, std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    if (!stream) throw Error(Exit::misuse, file + ": cannot be read");
    try {
        const conformance::Report report = conformance::read_report(text, line.values("only"));
        cli::print(conformance::text_report(report, line.has("quiet")));
        return static_cast<int>(report.is_well() ? Exit::done : Exit::run_failed);
    } catch (const conformance::Refused& refused) {
        throw Error(Exit::misuse, file + ": " + refused.what());
    }
}

int answer(const cli::CommandLine& line) {
    if (line.wants_help()) {
        cli::print("pelorus-conform is started by `pelorus conform`; see: pelorus help conform\n");
        return 0;
    }
    if (line.has("list")) {
        for (const cli::Flag& flag : cli::conform_grammar().flags)
            if (line.has(flag.name) && flag.name != "list" && flag.name != "json")
                throw Error(Exit::misuse, "--list tells all checks; it takes no --" + flag.name);
        const std::string json = line.value("json");
        if (json.empty())
            cli::print(conformance::text_list());
        else
            write_to(json, conformance::json_list());
        return 0;
    }
    if (line.has("from")) return answer_from_report(line);
    const cli::Interrupt interrupt;
    Options options = read_options(line);
    options.stop = &interrupt.stop();
    host::Catalog catalog(cli::plugin_folders(line));
    const conform::SuiteHost host(catalog);
    conformance::Report report;
    try {
        if (line.has("names")) {
            cli::print(conformance::selected_names(host, options));
            return static_cast<int>(Exit::done);
        }
        report = conformance::run_checks(host, options);
    } catch (const conformance::Refused& refused) {
        throw Error(Exit::misuse, refused.what());
    }
    if (options.json != "-" && options.junit != "-") cli::print(conformance::text_report(report, options.is_quiet));
    write_to(options.json, conformance::json_report(report));
    write_to(options.junit, conformance::junit_report(report));
    return static_cast<int>(report.is_well() ? Exit::done : Exit::run_failed);
}

}  // namespace

int main(int argc, char** argv) {
    cli::prepare_streams();
    try {
        return answer(cli::CommandLine::parse("conform", cli::conform_grammar(), {argv + 1, argv + argc}));
    } catch (const cli::OutputClosed&) {
        return static_cast<int>(Exit::run_failed);
    } catch (const Error& problem) {
        cli::tell(problem.what());
        return static_cast<int>(problem.exit());
    } catch (const std::exception& problem) {
        cli::tell(std::string("unexpected error: ") + problem.what());
        return static_cast<int>(Exit::run_failed);
    }
}
