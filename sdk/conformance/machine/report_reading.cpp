// A report once more, from its JSON: a test of each check asks the one report of all.
#include <algorithm>

#include <nlohmann/json.hpp>

#include "runner.hpp"

namespace pelorus::conformance {

namespace {

using Json = nlohmann::json;

Result result_of(const Json& json) {
    Result result;
    const std::string name = json.at("name");
    result.check = find_check(name);
    if (result.check == nullptr) throw Refused("is of another version: there is no check " + name);
    result.plugin = json.at("plugin");
    result.kind = json.at("kind");
    const std::string verdict = json.at("verdict");
    if (!find_verdict(verdict)) throw Refused("is no report of conformance: there is no verdict " + verdict);
    result.outcome.verdict = *find_verdict(verdict);
    result.outcome.messages = json.at("messages").get<std::vector<std::string>>();
    result.outcome.notes = json.at("notes").get<std::vector<std::string>>();
    result.outcome.reason = json.value("reason", "");
    result.outcome.seconds = json.at("seconds");
    result.repeat = json.at("repeat");
    return result;
}

}  // namespace

Report read_report(const std::string& text, const std::vector<std::string>& only) {
    Report report;
    try {
        const Json json = Json::parse(text);
        report.library = json.at("library").get<std::string>();
        report.seed = json.at("seed");
        report.level = json.at("level");
        report.seconds = json.at("seconds");
        for (const Json& each : json.at("checks")) report.results.push_back(result_of(each));
    } catch (const Json::exception& problem) {
        throw Refused(std::string("is no report of conformance: ") + problem.what());
    }
    const auto has = [&](const std::string& name) {
        return std::any_of(report.results.begin(), report.results.end(),
                           [&](const Result& result) { return name == result.check->name; });
    };
    for (const std::string& name : only)
        if (!has(name)) throw Refused("tells nothing of a check " + name);
    const auto is_other = [&](const Result& result) {
        return !only.empty() && std::find(only.begin(), only.end(), result.check->name) == only.end();
    };
    report.results.erase(std::remove_if(report.results.begin(), report.results.end(), is_other), report.results.end());
    return report;
}

}  // namespace pelorus::conformance
