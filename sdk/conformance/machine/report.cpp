// What a run of checks came to, for people and for programs.
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "runner.hpp"

namespace pelorus::conformance {

namespace {

using Json = nlohmann::ordered_json;

std::map<Verdict, int> counts_of(const Report& report) {
    std::map<Verdict, int> counts;
    for (const Result& result : report.results) ++counts[result.outcome.verdict];
    return counts;
}

std::string indented(const std::string& text, const std::string& margin) {
    std::string out = margin;
    for (const char c : text) {
        out += c;
        if (c == '\n') out += margin;
    }
    return out + "\n";
}

std::string result_text(const Result& result) {
    const Outcome& outcome = result.outcome;
    std::string verdict = verdict_name(outcome.verdict);
    if (is_bad(outcome.verdict))
        for (char& c : verdict) c = static_cast<char>(std::toupper(c));
    std::string text = fmt::format("  {:<8}{}", verdict, result.check->name);
    if (outcome.verdict == Verdict::skipped) text += ": " + outcome.reason;
    const bool has_lines = outcome.notes.size() > 1;
    if (!has_lines)
        for (const std::string& note : outcome.notes) text += "  (" + note + ")";
    text += "\n";
    if (has_lines)
        for (const std::string& note : outcome.notes) text += indented(note, "          ");
    if (outcome.messages.empty()) return text;
    text += indented(result.check->law, "          ");
    for (const std::string& message : outcome.messages) text += indented(message, "          - ");
    if (is_bad(outcome.verdict)) text += "          repeat: " + result.repeat + "\n";
    return text;
}

std::string xml(const std::string& text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            default:
                out += static_cast<unsigned char>(c) < 0x20 && c != '\n' ? ' ' : c;
        }
    }
    return out;
}

Json check_json(const Check& check) {
    return {{"name", check.name},
            {"group", check.group},
            {"level", check.level},
            {"law", check.law},
            {"prerequisites", prerequisites_of(check)}};
}

}  // namespace

std::string text_report(const Report& report, bool is_quiet) {
    std::string text;
    std::string told = "?";
    for (const Result& result : report.results) {
        if (is_quiet && !is_bad(result.outcome.verdict)) continue;
        if (told != result.plugin) {
            told = result.plugin;
            text += told.empty() ? report.library.string() + "\n" : told + "\n";
        }
        text += result_text(result);
    }
    const auto counts = counts_of(report);
    const auto number = [&](Verdict verdict) {
        const auto found = counts.find(verdict);
        return found == counts.end() ? 0 : found->second;
    };
    text += fmt::format("{} passed", number(Verdict::pass));
    for (const Verdict verdict : {Verdict::warn, Verdict::fail, Verdict::crash, Verdict::hang, Verdict::skipped}) {
        static const std::map<Verdict, const char*> words{{Verdict::warn, "passed with a warning"},
                                                          {Verdict::fail, "failed"},
                                                          {Verdict::crash, "crashed"},
                                                          {Verdict::hang, "hung"},
                                                          {Verdict::skipped, "skipped"}};
        if (number(verdict) != 0) text += fmt::format(", {} {}", number(verdict), words.at(verdict));
    }
    if (report.was_interrupted) text += ", interrupted";
    return text + fmt::format("; levels 1 to {}, seed {}, {:.1f} s\n", report.level, report.seed, report.seconds);
}

std::string json_report(const Report& report) {
    Json json{{"library", report.library.string()},
              {"seed", report.seed},
              {"level", report.level},
              {"seconds", report.seconds},
              {"well", report.is_well()},
              {"counts", Json::object()},
              {"checks", Json::array()}};
    for (const auto& [verdict, count] : counts_of(report)) json["counts"][verdict_name(verdict)] = count;
    for (const Result& result : report.results) {
        Json each{{"plugin", result.plugin}, {"kind", result.kind}};
        each.update(check_json(*result.check));
        each["verdict"] = verdict_name(result.outcome.verdict);
        each["messages"] = result.outcome.messages;
        each["notes"] = result.outcome.notes;
        if (result.outcome.verdict == Verdict::skipped) each["reason"] = result.outcome.reason;
        each["seconds"] = result.outcome.seconds;
        each["repeat"] = result.repeat;
        json["checks"].push_back(std::move(each));
    }
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string junit_report(const Report& report) {
    const auto counts = counts_of(report);
    const auto number = [&](Verdict verdict) {
        const auto found = counts.find(verdict);
        return found == counts.end() ? 0 : found->second;
    };
    std::string text = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\" "
        "skipped=\"{}\" time=\"{:.3f}\">\n",
        xml(report.library.filename().string()), report.results.size(), number(Verdict::fail),
        number(Verdict::crash) + number(Verdict::hang), number(Verdict::skipped), report.seconds);
    for (const Result& result : report.results) {
        text += fmt::format("  <testcase classname=\"{}\" name=\"{}\" time=\"{:.3f}\">",
                            xml(result.plugin.empty() ? "library" : result.plugin), xml(result.check->name),
                            result.outcome.seconds);
        std::string messages;
        for (const std::string& message : result.outcome.messages) messages += message + "\n";
        if (result.outcome.verdict == Verdict::skipped)
            text += fmt::format("<skipped message=\"{}\"/>", xml(result.outcome.reason));
        else if (is_bad(result.outcome.verdict))
            text += fmt::format("<{0} type=\"{1}\" message=\"{2}\">{3}</{0}>",
                                result.outcome.verdict == Verdict::fail ? "failure" : "error",
                                verdict_name(result.outcome.verdict), xml(result.check->law),
                                xml(messages + "repeat: " + result.repeat));
        text += "</testcase>\n";
    }
    return text + "</testsuite>\n";
}

std::string text_list() {
    std::string text, group;
    for (const Check& check : checks()) {
        if (group != check.group) {
            text += (group.empty() ? "" : "\n") + std::string(check.group) + "\n";
            group = check.group;
        }
        text += fmt::format("  {} (level {})\n", check.name, check.level) + indented(check.law, "      ");
        const auto& needed = check.prerequisites;
        if (!needed.empty()) text += fmt::format("      after: {}\n", fmt::join(needed, ", "));
    }
    return text + fmt::format("\n{} checks\n", checks().size());
}

std::string json_list() {
    Json json = Json::array();
    for (const Check& check : checks()) json.push_back(check_json(check));
    return json.dump(2) + "\n";
}

}  // namespace pelorus::conformance
