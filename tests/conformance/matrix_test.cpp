// The suites prove themselves: every check has a saboteur that it catches (CHECK.so, and CHECK.VARIANT.so for further defects), and
// a near-miss that it lets pass (CHECK.near.so). The long cases try every other check on these libraries too: those that do not
// rest on the one pass.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <map>
#include <set>

#include <nlohmann/json.hpp>

#include "support/process.hpp"

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using pelorus::test::run;

const fs::path saboteurs = PELORUS_SABOTEURS;

Json listed_checks() {
    const auto listed = run({PELORUS_CONFORM, "--list", "--json=-"});
    REQUIRE(listed.exit == 0);
    return Json::parse(listed.out);
}

/// Names of the checks that rest on one, directly or not.
std::set<std::string> dependents_of(const Json& checks, const std::string& name) {
    std::set<std::string> found{name};
    for (std::size_t before = 0; before != found.size();) {
        before = found.size();
        for (const Json& check : checks)
            for (const Json& needed : check["prerequisites"])
                if (found.count(needed) != 0) found.insert(check["name"].get<std::string>());
    }
    found.erase(name);
    return found;
}

/// Which checks a library is given to.
enum class Extent { the_check, all };  // the check and what it rests on; levels 1 to 3 and, beyond them, the check

Json reported(const fs::path& library, const Json& check, Extent extent) {
    const std::string only = "--only=" + check["name"].get<std::string>();
    std::vector<std::string> words{PELORUS_CONFORM, library.string(), "--json=-", "--jobs=1"};
    const fs::path subjects = fs::path(PELORUS_SABOTEUR_SUBJECTS) / (check["name"].get<std::string>() + ".yaml");
    if (fs::exists(subjects)) words.push_back("--subjects=" + subjects.string());
    if (extent == Extent::the_check) words.push_back(only);
    const pelorus::test::Ended ended = run(words);
    INFO(library.string() << ": " << ended.err);
    REQUIRE(fs::exists(library));
    REQUIRE_FALSE(ended.out.empty());
    Json all = Json::parse(ended.out)["checks"];
    if (extent == Extent::all && check["level"] > 3) {
        words.push_back(only);
        const Json report = Json::parse(run(words).out);
        for (const Json& more : report["checks"])
            if (more["level"] > 3) all.push_back(more);
    }
    return all;
}

std::string told(const Json& result) {
    std::string text = result["name"].get<std::string>() + ": " + result["verdict"].get<std::string>();
    for (const Json& message : result["messages"]) text += "\n  " + message.get<std::string>();
    if (result.contains("reason")) text += "\n  " + result["reason"].get<std::string>();
    return text;
}

bool is_bad(const Json& result) {
    return result["verdict"] == "fail" || result["verdict"] == "crash" || result["verdict"] == "hang";
}

/// Of `CHECK-long`: whether CHECK, which tries the same for a shorter time, was so lucky as to see it already.
bool is_seen_early(const Json& results, const std::string& name) {
    const std::string ending = "-long";
    if (name.size() <= ending.size() || name.compare(name.size() - ending.size(), ending.size(), ending) != 0)
        return false;
    const std::string brief = name.substr(0, name.size() - ending.size());
    return std::any_of(results.begin(), results.end(),
                       [&](const Json& result) { return result["name"] == brief && is_bad(result); });
}

void try_saboteur(const Json& checks, const Json& check, Extent extent) {
    const std::string name = check["name"];
    const std::set<std::string> dependents = dependents_of(checks, name);
    bool is_caught = false;
    const Json results = reported(saboteurs / (name + ".so"), check, extent);
    if (is_seen_early(results, name)) return;
    for (const Json& result : results) {
        INFO(told(result));
        const std::string each = result["name"];
        if (each == name) {
            is_caught = is_caught || is_bad(result);
            CHECK(is_bad(result));
            if (is_bad(result)) CHECK_FALSE(result["messages"].empty());
        } else if (dependents.count(each) != 0) {
            CHECK(result["verdict"] == "skipped");
        } else {
            CHECK_FALSE(is_bad(result));
        }
    }
    CHECK(is_caught);
}

/// More defects of the same law, CHECK.VARIANT.so: that they are caught by it is all that is asked.
void try_variants(const std::string& name) {
    for (const auto& entry : fs::directory_iterator(saboteurs)) {
        const std::string file = entry.path().filename();
        if (file.rfind(name + ".", 0) != 0 || file == name + ".so" || file == name + ".near.so") continue;
        if (entry.path().extension() != ".so") continue;
        const auto ended = run({PELORUS_CONFORM, entry.path().string(), "--json=-", "--jobs=1", "--only=" + name});
        INFO(file << ": " << ended.err);
        REQUIRE_FALSE(ended.out.empty());
        const Json report = Json::parse(ended.out);
        bool is_caught = false;
        for (const Json& result : report["checks"]) {
            INFO(told(result));
            if (result["name"] == name)
                is_caught = is_caught || result["verdict"] == "fail";
            else
                CHECK_FALSE(is_bad(result));
        }
        CHECK(is_caught);
    }
}

void try_near_miss(const Json& check, Extent extent) {
    bool is_tried = false;
    for (const Json& result : reported(saboteurs / (check["name"].get<std::string>() + ".near.so"), check, extent)) {
        INFO(told(result));
        CHECK_FALSE(is_bad(result));
        is_tried = is_tried || (result["name"] == check["name"] && result["verdict"] != "skipped");
    }
    CHECK(is_tried);
}

/// Groups that have a case below.
std::set<std::string>& tried_groups() {
    static std::set<std::string> groups;
    return groups;
}
struct TriedGroup {
    explicit TriedGroup(const char* group) { tried_groups().insert(group); }
};

/// One case a group, so that they run side by side.
void try_group(const std::string& group, Extent extent) {
    const Json checks = listed_checks();
    for (const Json& check : checks) {
        if (check["group"] != group) continue;
        if (check["name"] == "threads-race-free") continue;  // skipped in this build; the preset tsan tries it
        DYNAMIC_SECTION(check["name"].get<std::string>()) {
            try_saboteur(checks, check, extent);
            if (extent == Extent::the_check) try_variants(check["name"]);
            try_near_miss(check, extent);
        }
    }
}

}  // namespace

TEST_CASE("Every conformance check has a saboteur and a near-miss") {
    std::set<std::string> names;
    for (const Json& check : listed_checks()) {
        const std::string name = check["name"];
        CAPTURE(name);
        CHECK(names.insert(name).second);
        CHECK(fs::exists(saboteurs / (name + ".so")));
        CHECK(fs::exists(saboteurs / (name + ".near.so")));
        CHECK_FALSE(check["law"].get<std::string>().empty());
        CHECK(tried_groups().count(check["group"]) == 1);
    }
    CHECK(names.size() >= 70);
    for (const auto& entry : fs::directory_iterator(saboteurs)) {
        if (entry.path().extension() != ".so") continue;
        const std::string name = entry.path().stem().stem().string();
        CAPTURE(name);
        CHECK(names.count(name) == 1);
    }
}

TEST_CASE("A conformance check rests on checks of no higher level that are there") {
    const Json checks = listed_checks();
    std::map<std::string, int> levels;
    for (const Json& check : checks) levels[check["name"]] = check["level"];
    for (const Json& check : checks)
        for (const Json& needed : check["prerequisites"]) {
            CAPTURE(check["name"], needed);
            REQUIRE(levels.count(needed) == 1);
            CHECK(levels[needed] <= check["level"]);
        }
}

#define SABOTEUR_GROUP(group)                                                                                        \
    static const TriedGroup INTERNAL_CATCH_UNIQUE_NAME(tried_group)(group);                                          \
    TEST_CASE("Saboteurs of the group " group " are caught by their check") { try_group(group, Extent::the_check); } \
    TEST_CASE("Saboteurs of the group " group " are caught by their check alone", "[long]") {                        \
        try_group(group, Extent::all);                                                                               \
    }
SABOTEUR_GROUP("library")
SABOTEUR_GROUP("every")
SABOTEUR_GROUP("stage")
SABOTEUR_GROUP("model")
SABOTEUR_GROUP("motion")
SABOTEUR_GROUP("sensor")
SABOTEUR_GROUP("estimator")
SABOTEUR_GROUP("extent")
SABOTEUR_GROUP("partitioner")
SABOTEUR_GROUP("waveform")
SABOTEUR_GROUP("trajectory")
SABOTEUR_GROUP("source")
SABOTEUR_GROUP("registration")
SABOTEUR_GROUP("fusion")
SABOTEUR_GROUP("tracker")
SABOTEUR_GROUP("scheduler")
SABOTEUR_GROUP("analyzer")
SABOTEUR_GROUP("sink")
