// What every stage owes the graph: ports that say what they carry, messages that are what was said, and manners with those of others.
#include <cstring>
#include <deque>
#include <set>

#include "machine/lent_message.hpp"
#include "machine/message_fields.hpp"
#include "machine/message_words.hpp"
#include "machine/stage_bench.hpp"

namespace pelorus::conformance {

namespace {

std::string port_name(const Instance& instance, bool is_output, std::uint32_t port) {
    const plr_description& d = instance.description();
    return std::string(is_output ? "out port " : "in port ") +
           element_of(is_output ? d.out_ports : d.in_ports, port).name;
}

/// What is wrong with a space, "" if nothing is.
std::string fault_of(const plr_space& space) {
    if (space.size == 0 || space.components == nullptr) return "has a space without components";
    std::set<std::string> names;
    for (std::uint32_t i = 0; i < space.size; ++i) {
        const plr_component& component = element_of(space.components, i);
        if (component.name == nullptr || component.name[0] == 0 || component.unit == nullptr)
            return "has a space whose component " + std::to_string(i) + " lacks a name or a unit";
        if (!names.insert(component.name).second)
            return std::string("has a space with the component ") + component.name + " twice";
    }
    return {};
}

std::string fault_of(const plr_stream& stream, bool is_output, std::uint32_t message) {
    if (is_output && stream.space == nullptr) return "has a stream without a space, which only in ports may leave open";
    if (is_output && stream.frame == nullptr) return "has a stream without a frame, which only in ports may leave open";
    if (is_output && message == PLR_MESSAGE_SCAN && stream.sensor == nullptr)
        return "has a stream of scans without a sensor's name";
    if (message != PLR_MESSAGE_SCAN && stream.sensor != nullptr && stream.sensor[0] != 0)
        return std::string("has a stream with the sensor ") + stream.sensor + ", but carries no scans";
    return stream.space == nullptr ? std::string() : fault_of(*stream.space);
}

std::string words_of(const plr_port_type& type) {
    std::string words = std::to_string(type.passes_on);
    for (std::uint32_t s = 0; s < type.stream_count; ++s) {
        const plr_stream& stream = element_of(type.streams, s);
        words += std::string("|") + (stream.sensor == nullptr ? "any" : stream.sensor) + "|" +
                 (stream.frame == nullptr ? "any" : stream.frame);
        for (std::uint32_t i = 0; stream.space != nullptr && i < stream.space->size; ++i)
            words += std::string(",") + element_of(stream.space->components, i).name;
    }
    return words;
}

/// All ports of an instance, as their types say.
std::vector<std::string> all_types(const Instance& instance) {
    const plr_description& d = instance.description();
    std::vector<std::string> words;
    for (std::uint32_t p = 0; p < d.in_port_count; ++p) words.push_back(words_of(port_type_of(instance, false, p)));
    for (std::uint32_t p = 0; p < d.out_port_count; ++p) words.push_back(words_of(port_type_of(instance, true, p)));
    return words;
}

void check_port(const Instance& instance, bool is_output, std::uint32_t port) {
    const plr_description& d = instance.description();
    const std::string name = port_name(instance, is_output, port);
    const plr_port_type type = port_type_of(instance, is_output, port);
    const std::uint32_t message = element_of(is_output ? d.out_ports : d.in_ports, port).message;
    if (type.struct_size < sizeof(plr_port_type)) FAIL(name << ": port_type left struct_size at " << type.struct_size);
    if (type.stream_count > 0 && type.streams == nullptr)
        FAIL(name << " has " << type.stream_count << " streams at NULL");
    if (type.passes_on > d.in_port_count)
        FAIL(name << " passes on in port " << type.passes_on - 1 << ", there are " << d.in_port_count);
    std::set<std::string> sensors;
    for (std::uint32_t s = 0; s < type.stream_count; ++s) {
        const plr_stream& stream = element_of(type.streams, s);
        const std::string fault = fault_of(stream, is_output, message);
        if (!fault.empty()) FAIL(name << " " << fault);
        if (message == PLR_MESSAGE_SCAN && !sensors.insert(stream.sensor == nullptr ? "" : stream.sensor).second)
            FAIL(name << " names the sensor " << (stream.sensor == nullptr ? "NULL" : stream.sensor) << " twice");
    }
}

/// The streams that may come out of a port, those that it passes on included; `is_open`: any.
std::vector<plr_stream> streams_of(const Instance& instance, std::uint32_t port, bool& is_open) {
    const plr_port_type own = port_type_of(instance, true, port);
    std::vector<plr_stream> streams;
    for (std::uint32_t s = 0; s < own.stream_count; ++s) streams.push_back(element_of(own.streams, s));
    if (own.passes_on != 0) {
        const plr_port_type other = port_type_of(instance, false, own.passes_on - 1);
        is_open = is_open || other.stream_count == 0;
        for (std::uint32_t s = 0; s < other.stream_count; ++s) streams.push_back(element_of(other.streams, s));
    }
    for (plr_stream& stream : streams) stream.struct_size = sizeof stream;
    is_open = is_open || streams.empty();
    return streams;
}

void check_published(const Bench& bench, const Instance& instance, const PublishedMessage& published) {
    const plr_description& d = instance.description();
    if (published.port >= d.out_port_count)
        FAIL("a " << brief(*published.message) << " was published on port " << published.port
                  << "; the description has " << d.out_port_count << " out ports");
    const plr_port& port = element_of(d.out_ports, published.port);
    if (published.message->kind != port.message)
        FAIL("a " << brief(*published.message) << " was published on out port " << port.name << ", which carries "
                  << message_kind_name(port.message));
    bool is_open = false;
    const std::vector<plr_stream> streams = streams_of(instance, published.port, is_open);
    if (is_open) return;
    const plr_port_type declared{sizeof declared, static_cast<std::uint32_t>(streams.size()), streams.data(), 0, 0};
    try {
        bench.host().check_stream(*published.message, declared);
    } catch (const Refused& refused) {
        FAIL("a " << brief(*published.message) << " was published on out port " << port.name
                  << ", which declares no such stream: " << refused.what());
    }
}

}  // namespace

PELORUS_CHECK(stage, "stage-ports-say-what-they-carry", 2,
              "port_type answers for every port, with complete streams, the same as long as the instance lives; the "
              "graph is checked by it once, before anything runs.",
              {}) {
    StagePlayer player(bench);
    const plr_description& d = player.instance().description();
    for (std::uint32_t port = 0; port < d.in_port_count; ++port) check_port(player.instance(), false, port);
    for (std::uint32_t port = 0; port < d.out_port_count; ++port) check_port(player.instance(), true, port);
    const std::vector<std::string> before = all_types(player.instance());
    const Script script = plain_script(bench);
    for (std::size_t i = 0; i < std::min<std::size_t>(script.deliveries.size(), 12); ++i)
        player.receive(script.deliveries[i].port, *script.deliveries[i].message);
    const std::vector<std::string> after = all_types(player.instance());
    for (std::size_t p = 0; p < before.size(); ++p) {
        const bool is_output = p >= d.in_port_count;
        if (before[p] != after[p])
            FAIL(
                port_name(player.instance(), is_output, static_cast<std::uint32_t>(is_output ? p - d.in_port_count : p))
                << " changed its streams while the stage ran: " << before[p] << " became " << after[p]);
    }
}

PELORUS_CHECK(stage, "stage-takes-what-it-asks-for", 2,
              "Plain messages of the streams that a stage asked for are taken, events of a source are emitted, and "
              "finish goes well; a stage that refuses its own streams refuses every graph.",
              {"stage-ports-say-what-they-carry"}) {
    const Script script = plain_script(bench);
    StagePlayer player(bench);
    std::vector<int> offered(player.instance().description().in_port_count), taken = offered;
    std::string why;
    for (std::size_t i = 0; i < script.steps(); ++i) {
        if (i < script.deliveries.size()) {
            const Delivery& delivery = script.deliveries[i];
            const Answer answer = player.deliver(delivery);
            ++offered[delivery.port];
            if (answer.is_ok())
                ++taken[delivery.port];
            else if (why.empty())
                why = answer.told;
        }
        if (i < script.events && player.is_source()) player.emit_next();
    }
    player.finish_well();
    for (std::uint32_t port = 0; port < offered.size(); ++port) {
        const std::uint32_t kind = element_of(player.instance().description().in_ports, port).message;
        if (kind == PLR_MESSAGE_VALUES || kind == PLR_MESSAGE_TABLE) continue;  // nobody knows which names it wants
        if (offered[port] > 0 && taken[port] == 0)
            FAIL(port_name(player.instance(), false, port)
                 << " refuses each of " << offered[port] << " messages of its own streams: " << why);
    }
}

PELORUS_CHECK(
    stage, "stage-publishes-what-it-declares", 2,
    "What a stage publishes is a message as message.h says, on a port of its description, of that port's kind "
    "and of one of the streams that the port declares; the graph was checked by those.",
    {"stage-takes-what-it-asks-for"}) {
    const Script script = plain_script(bench);
    StagePlayer player(bench);
    play(player, script);
    player.finish_well();
    for (const PublishedMessage& published : player.published()) check_published(bench, player.instance(), published);
}

PELORUS_CHECK(stage, "stage-publishes-only-when-it-may", 2,
              "A stage publishes from within receive, emit and finish, and never in create, next, save or load: the "
              "host is not listening then, and the message is lost.",
              {"stage-takes-what-it-asks-for"}) {
    const Script script = plain_script(bench);
    StagePlayer player(bench);
    const auto must_be_silent = [&](const char* function) {
        if (!player.services().refused_messages.empty())
            FAIL("a message was published in " << function << ": " << player.services().refused_messages.front());
    };
    must_be_silent("create");
    play(player, script, 0, script.steps() / 2);
    must_be_silent("receive, emit or next");
    if (player.is_source()) {
        player.next();
        must_be_silent("next");
    }
    if (player.saves()) {
        const Bytes state = player.save();
        must_be_silent("save");
        player.load(state);
        must_be_silent("load");
    }
}

PELORUS_CHECK(stage, "stage-leaves-messages-alone", 2,
              "A received message is not written to: the next stage gets the same memory.",
              {"stage-takes-what-it-asks-for"}) {
    const Script script = plain_script(bench);
    if (script.deliveries.empty()) skip("nothing comes in");
    StagePlayer player(bench);
    std::deque<LentMessage> lent;
    for (const Delivery& delivery : script.deliveries) {
        lent.emplace_back(*delivery.message, ZoneName{"receive", brief(*delivery.message)});
        lent.back().make_read_only();
        player.receive(delivery.port, lent.back().message());
    }
}

PELORUS_CHECK(
    stage, "stage-keeps-no-message", 2,
    "A received message is lent for the call: a stage copies what it wants to keep, for the memory belongs to "
    "somebody else as soon as receive returns.",
    {"stage-takes-what-it-asks-for"}) {
    const Script script = plain_script(bench);
    if (script.deliveries.empty()) skip("nothing comes in");
    StagePlayer player(bench);
    std::deque<LentMessage> lent;
    for (const Delivery& delivery : script.deliveries) {
        lent.emplace_back(*delivery.message, ZoneName{"receive", brief(*delivery.message)});
        player.receive(delivery.port, lent.back().message());
        lent.back().take_back();
    }
    player.finish_well();
    if (player.saves()) player.save();
}

}  // namespace pelorus::conformance
