#include "spy_log.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include <pelorus/abi/abi.h>

namespace pelorus::test {

namespace {

using Call = SpyLog::Call;

std::string name(const Call& call) { return call["call"]; }
std::string at(const Call& call) { return call["at"]; }
std::uint64_t began(const Call& call) { return call["begin"]; }
std::uint64_t ended(const Call& call) { return call["end"]; }
bool is_any(const Call& call, const std::set<std::string>& names) { return names.count(name(call)) > 0; }

bool is_main(const Call& call) { return is_any(call, {"init", "deinit", "factory", "create", "destroy", "port_type"}); }
bool is_of_model(const Call& call) {
    return is_any(call, {"propagate", "jacobian", "noise", "measure", "residual", "body"});
}

/// Calls of a selection that were under way at the same time.
int overlaps(std::vector<Call> calls) {
    std::sort(calls.begin(), calls.end(), [](const Call& a, const Call& b) { return began(a) < began(b); });
    int found = 0;
    for (std::size_t i = 1; i < calls.size(); ++i) found += began(calls[i]) < ended(calls[i - 1]);
    return found;
}

/// Something that the host handled: since when it was to be handled, when it was, and its place in the order of events.
struct Handled {
    std::uint64_t known, when;
    std::tuple<std::int64_t, std::int64_t, std::size_t, std::uint64_t> key;  // arrival, time, node, sequence
};

}  // namespace

bool is_run_call(const Call& call) { return is_any(call, {"next", "emit", "receive", "finish", "save", "load"}); }

SpyLog::SpyLog(const std::filesystem::path& file) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) calls_.push_back(Call::parse(line));
    REQUIRE(!calls_.empty());
    std::sort(calls_.begin(), calls_.end(), [](const Call& a, const Call& b) { return began(a) < began(b); });
}

std::vector<Call> SpyLog::where(const std::function<bool(const Call&)>& wanted) const {
    std::vector<Call> found;
    std::copy_if(calls_.begin(), calls_.end(), std::back_inserter(found), wanted);
    return found;
}

std::vector<Call> SpyLog::named(const std::string& call) const {
    return where([&](const Call& one) { return name(one) == call; });
}

std::vector<Call> SpyLog::of(const std::string& address, const std::string& call) const {
    return where([&](const Call& one) { return at(one) == address && name(one) == call; });
}

std::vector<std::string> SpyLog::created() const {
    std::vector<std::string> addresses;
    for (const Call& call : named("create")) addresses.push_back(at(call));
    return addresses;
}

void SpyLog::check_lifecycle() const {
    CHECK(named("init").size() == 1);  // once, before the first factory call
    CHECK(name(calls_.front()) == "init");
    CHECK(named("deinit").size() == 1);  // once, at the end of the process
    CHECK(name(calls_.back()) == "deinit");
    CHECK(calls_.back()["instances"] == 0);
    const std::vector<std::string> addresses = created();
    for (const std::string& address : addresses) {
        CAPTURE(address);
        const std::vector<Call> own = where([&](const Call& call) { return at(call) == address; });
        CHECK(name(own.front()) == "create");
        CHECK(name(own.back()) == "destroy");
        CHECK(of(address, "create").size() == 1);
        CHECK(of(address, "destroy").size() == 1);
        CHECK(own.back()["config"] == "valid");  // plr_config: valid while the instance lives
        const std::size_t last_dot = address.rfind('.');
        if (last_dot == std::string::npos) continue;
        const std::string holder = address.substr(0, last_dot);
        CHECK(ended(own.front()) < began(of(holder, "create").front()));
        CHECK(ended(of(holder, "destroy").front()) < began(own.back()));  // plr_table_head: its parts are still alive
    }
    std::set<std::string> keys;  // plr_config.key: of seed, run and node
    std::set<std::string> nodes;
    for (const Call& call : named("create")) {
        keys.insert(call["key"].get<std::string>());
        nodes.insert(at(call).substr(0, at(call).find('.')));
    }
    CHECK(keys.size() == nodes.size());
}

void SpyLog::check_contexts() const {
    for (const Call& call : calls_) {
        CAPTURE(call.dump());
        if (call.contains("error")) CHECK(call["error"] == "clean");
        if (name(call) == "create") {
            CHECK(call["size"] == sizeof(plr_config));
            CHECK(call["host"] == sizeof(plr_host));
            CHECK(call["major"] == PLR_ABI_MAJOR);
            CHECK(call["minor"] == PLR_ABI_MINOR);
            CHECK(call["services"] == "all");
            CHECK(call["frame"] == "");
        }
        if (name(call) == "port_type") {
            CHECK(call["out"] == sizeof(plr_port_type));
            CHECK(call["streams"] == 0);
        }
        if (name(call) == "next") CHECK(call["out"] == sizeof(plr_next));
        if (name(call) == "save") CHECK(call["writer"] == sizeof(plr_writer));
        if (name(call) == "receive") CHECK(call["size"] == sizeof(plr_message));
        if (name(call) == "propagate") CHECK(call["args"] == sizeof(plr_motion_propagate));
        if (name(call) == "measure") CHECK(call["args"] == sizeof(plr_sensor_measure));
        if (name(call) == "body") CHECK((call["aligned"] == 1 && call["used"] == 0));
        if (!call.contains("context")) continue;
        const Call& context = call["context"];
        CHECK(context["size"] == sizeof(plr_call));
        CHECK(context["reserved"] == 0);
        CHECK(context["error"] == "clean");
        CHECK(context["log"] == "there");
        CHECK(context["aligned"] == 1);
        if (is_of_model(call)) {  // what its holder passes comes through
            CHECK((call["scratch_free"] == 1 && call["status_clean"] == 1 && call["out"] == 1));
            CHECK((context["ids"] == 1 && context["inputs"] == 1 && context["item_status"] == 1));
            CHECK(call["first_id"] == 100 + context["item_offset"].get<int>());
        } else {
            CHECK((context["used"] == 0 && context["scratch"].get<std::int64_t>() > 0));
            CHECK((context["item_offset"] == 0 && context["ids"] == 0 && context["keys"] == 0));
        }
    }
}

void SpyLog::check_threads() const {
    std::vector<Call> main = where(is_main);
    CHECK(overlaps(main) == 0);
    for (const std::string& address : created()) {
        CAPTURE(address);
        const auto exclusive = [&](const Call& call) {
            return at(call) == address && (is_run_call(call) || is_main(call));
        };
        CHECK(overlaps(where(exclusive)) == 0);
    }
}

void SpyLog::check_order(const std::vector<std::string>& nodes) const {
    const auto place = [&](const std::string& node) {
        return static_cast<std::size_t>(std::find(nodes.begin(), nodes.end(), node) - nodes.begin());
    };
    constexpr auto after_messages = std::numeric_limits<std::uint64_t>::max();
    std::vector<Handled> handled;
    std::map<std::uint64_t, std::uint64_t> published;  // sequence -> when the call that published it ended
    std::map<std::string, Call> announced;             // by source: its latest answer to next
    std::map<std::string, std::uint64_t> known;        // by source: when its next event was to be handled
    std::uint64_t sequence = 0;
    std::int64_t now = std::numeric_limits<std::int64_t>::min();
    for (const Call& call : where(is_run_call)) {
        CAPTURE(call.dump());
        const std::string node = at(call);
        if (name(call) == "next") announced[node] = call;
        if (name(call) == "emit") {
            REQUIRE(announced.count(node) == 1);  // next is asked again before each event
            const Call next = announced[node];
            announced.erase(node);
            CHECK(next["what"] == static_cast<int>(PLR_NEXT_DATA));
            CHECK(call["context"]["time"] == next["arrival"]);
            const std::int64_t arrival = next["arrival"], delay = next["delay"];
            handled.push_back({known[node], began(call), {arrival, arrival - delay, place(node), after_messages}});
            known[node] = ended(call);
            published[sequence++] = ended(call);
        }
        if (name(call) == "receive" || name(call) == "finish" || name(call) == "emit") {
            CHECK(call["context"]["time"].get<std::int64_t>() >= now);  // time does not run backward
            now = call["context"]["time"];
        }
        if (name(call) == "receive" && call["kind"] != static_cast<int>(PLR_MESSAGE_VALUES)) {
            CHECK(call["context"]["time"] == call["arrival"]);  // its own, but on a feedback edge
            REQUIRE(published.count(call["sequence"]) == 1);
            CHECK(published[call["sequence"]] < began(call));
            handled.push_back({published[call["sequence"]],
                               began(call),
                               {call["arrival"], call["time"], place(call["origin"]), call["sequence"]}});
        }
        const bool publishes =
            is_any(call, {"receive", "finish"}) && call["answer"] == 0 && !of(node + ".motion", "create").empty();
        for (int i = 0; publishes && i < 2; ++i) published[sequence++] = ended(call);
    }
    int wrong = 0;
    for (std::size_t i = 0; i < handled.size(); ++i)
        for (std::size_t j = i + 1; j < handled.size(); ++j)
            wrong += handled[j].known < handled[i].when && handled[j].key < handled[i].key;
    CHECK(wrong == 0);
    CHECK(handled.size() > 10);
}

void SpyLog::check_finish(const std::vector<std::string>& graph_order) const {
    std::vector<std::string> finished;
    for (const Call& call : named("finish")) finished.push_back(at(call));
    CHECK(finished == graph_order);
    for (const std::string& node : finished) {
        CAPTURE(node);
        const std::uint64_t over = ended(of(node, "finish").front());
        // Later nodes get what earlier ones publish in finish before their own; nobody gets anything after it.
        CHECK(where([&](const Call& call) {
                  return at(call) == node && is_run_call(call) && began(call) > over;
              }).empty());
    }
}

}  // namespace pelorus::test
