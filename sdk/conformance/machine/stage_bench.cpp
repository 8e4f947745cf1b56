#include "stage_bench.hpp"

#include <utility>

#include "message_fields.hpp"
#include "message_words.hpp"

namespace pelorus::conformance {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t scratch_size = std::size_t{1} << 20;  // bytes
constexpr std::size_t most_events = 18;

}  // namespace

StagePlayer::StagePlayer(const Bench& bench, PlayOptions options)
    : options_(std::move(options)), services_(bench.host()), scratch_(scratch_size / sizeof(std::uint64_t)) {
    if (options_.folder.empty()) own_folder_ = std::make_unique<TemporaryFolder>();
    services_.output_folder = (own_folder_ ? own_folder_->path() : options_.folder).string();
    services_.threads = options_.threads;
    services_.allows_publishing = false;
    Surroundings surroundings;
    surroundings.services = &services_;
    surroundings.extra_struct_bytes = options_.extra_struct_bytes;
    if (options_.key) surroundings.key = *options_.key;
    instance_ = bench.make(surroundings);
}

StagePlayer::~StagePlayer() = default;

std::map<std::string, std::string> StagePlayer::files() const {
    std::error_code ignored;
    return fs::is_directory(folder(), ignored) ? contents_of(folder()) : std::map<std::string, std::string>();
}

template <class Body> Answer StagePlayer::call(const char* function, std::int64_t time, bool publishes, Body&& body) {
    plr_error error = empty_error();
    plr_scratch scratch{};
    const auto address = reinterpret_cast<std::uintptr_t>(scratch_.data());
    const std::uintptr_t shift = (64 - address % 64) % 64;
    scratch.data = reinterpret_cast<unsigned char*>(address + shift);
    scratch.size = scratch_size - 64;
    plr_call context{};
    context.struct_size = sizeof context;
    context.time = time;
    context.scratch = &scratch;
    context.error = &error;
    context.log = services_.log_service();
    const std::size_t before = services_.published.size(), refused = services_.refused_messages.size();
    services_.allows_publishing = publishes;
    Answer answer;
    std::string left_by;
    {
        watch::Guard guard(publishes ? options_.watch : 0);
        try {
            if (publishes) watch::fail_allocation(std::exchange(failing_allocation, -1));
            answer.status = body(context);
        } catch (const std::exception& exception) {
            left_by = exception.what();
        } catch (...) {
            left_by = "of a type of its own";
        }
        watch::fail_allocation(-1);
        const watch::Offence seen = guard.end();
        if (seen.function != nullptr && offence.function == nullptr) {
            offence = seen;
            offence_in = function;
        }
    }
    services_.allows_publishing = false;
    if (!left_by.empty()) FAIL("an exception left " << function << ": " << left_by);
    if (answer.status != PLR_OK && status_name(answer.status) == nullptr)
        FAIL(function << " answered " << answer.status << ", which is no status");
    // As the host does: what a failed call published is not sent, and a message that is refused fails the call.
    if (answer.status == PLR_OK && services_.refused_messages.size() > refused && publishes) {
        answer.status = PLR_E_ARGUMENT;
        answer.told = "PLR_OK although publish refused its message: " + services_.refused_messages.back();
    } else {
        answer.told = conformance::told(answer.status, error);
    }
    if (answer.status != PLR_OK || !options_.keeps_published) services_.published.resize(before);
    return answer;
}

Answer StagePlayer::receive(std::uint32_t port, const plr_message& message) {
    if (table().receive == nullptr) return {PLR_E_UNSUPPORTED, "receive is NULL"};
    last_time_ = std::max(last_time_, message.arrival);
    return call("receive", message.arrival, true,
                [&](const plr_call& context) { return table().receive(instance_->self(), &context, port, &message); });
}

plr_next StagePlayer::next() {
    plr_next answer{};
    answer.struct_size = sizeof answer;
    const Answer told = call("next", last_time_, false, [&](const plr_call& context) {
        return table().next(instance_->self(), &context, &answer);
    });
    if (!told.is_ok()) FAIL("next answered " << told.told);
    if (answer.what < PLR_NEXT_DATA || answer.what > PLR_NEXT_END)
        FAIL("next answered what = " << answer.what << ", expected PLR_NEXT_DATA, PLR_NEXT_WAIT or PLR_NEXT_END");
    return answer;
}

Answer StagePlayer::emit(std::int64_t arrival) {
    last_time_ = std::max(last_time_, arrival);
    return call("emit", arrival, true,
                [&](const plr_call& context) { return table().emit(instance_->self(), &context); });
}

Answer StagePlayer::finish() {
    if (table().finish == nullptr) return {};
    return call("finish", last_time_, true,
                [&](const plr_call& context) { return table().finish(instance_->self(), &context); });
}

Bytes StagePlayer::save() {
    Bytes bytes;
    const plr_writer writer{sizeof writer, 0, &bytes,
                            [](void* context, const void* data, std::uint64_t size, plr_error*) {
                                const auto* const first = static_cast<const unsigned char*>(data);
                                auto& to = *static_cast<Bytes*>(context);
                                to.insert(to.end(), first, first + size);
                                return plr_status{PLR_OK};
                            }};
    const Answer answer = call("save", last_time_, false, [&](const plr_call& context) {
        return table().save(instance_->self(), &writer, context.error);
    });
    if (!answer.is_ok()) FAIL("save answered " << answer.told);
    return bytes;
}

Answer StagePlayer::load(const Bytes& bytes) {
    // An address of its own: a reader past the end is stopped where memory is watched, and never finds what was there before.
    const Bytes copy(bytes.begin(), bytes.end());
    return call("load", last_time_, false, [&](const plr_call& context) {
        return table().load(instance_->self(), copy.data(), copy.size(), context.error);
    });
}

Answer StagePlayer::deliver(const Delivery& delivery) {
    const Answer answer = receive(delivery.port, *delivery.message);
    if (answer.is_ok() || answer.is_refusal()) return answer;
    FAIL("receive answered " << answer.told << " to a " << brief(*delivery.message) << " at port "
                             << element_of(instance_->description().in_ports, delivery.port).name
                             << "; a message that is not to its liking is PLR_E_DATA, any other error ends the run");
    return answer;
}

bool StagePlayer::emit_next() {
    const plr_next coming = next();
    if (coming.what != PLR_NEXT_DATA) return false;
    const Answer answer = emit(coming.arrival);
    if (!answer.is_ok()) FAIL("emit answered " << answer.told << " to the event at " << coming.arrival << " ns");
    return true;
}

void StagePlayer::finish_well() {
    const Answer answer = finish();
    if (!answer.is_ok()) FAIL("finish answered " << answer.told);
}

Script plain_script(const Bench& bench, const FeedOptions& options) {
    StagePlayer probe(bench);
    Script script;
    script.deliveries = Feed(bench, probe.instance(), bench.sample(1), options).deliveries();
    if (probe.is_source()) script.events = most_events;
    const plr_description& description = probe.instance().description();
    std::vector<char> is_closed(description.in_port_count, 0), is_tried(description.in_port_count, 0);
    for (const Delivery& delivery : script.deliveries) {
        if (is_tried[delivery.port] != 0) continue;
        is_tried[delivery.port] = 1;
        const bool is_optional = (element_of(description.in_ports, delivery.port).flags & PLR_PORT_OPTIONAL) != 0;
        const Answer answer = probe.receive(delivery.port, *delivery.message);
        is_closed[delivery.port] = is_optional && answer.status == PLR_E_UNSUPPORTED ? 1 : 0;
    }
    auto& all = script.deliveries;
    all.erase(std::remove_if(all.begin(), all.end(), [&](const Delivery& each) { return is_closed[each.port] != 0; }),
              all.end());
    return script;
}

void play(StagePlayer& player, const Script& script, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
        if (i < script.deliveries.size()) player.deliver(script.deliveries[i]);
        if (i < script.events && player.is_source()) player.emit_next();
    }
}

void play(StagePlayer& player, const Script& script) { play(player, script, 0, script.steps()); }

Trace trace_of(StagePlayer& player) { return {player.published(), player.files()}; }

std::string difference_of(const Trace& one, const Trace& other) {
    for (std::size_t i = 0; i < std::min(one.published.size(), other.published.size()); ++i) {
        const PublishedMessage &mine = one.published[i], &theirs = other.published[i];
        const std::string which = "published message " + std::to_string(i) + ", " + brief(*mine.message);
        if (mine.port != theirs.port)
            return which + ": port " + std::to_string(mine.port) + " against " + std::to_string(theirs.port);
        const std::string difference = difference_of(*mine.message, *theirs.message);
        if (!difference.empty()) return which + ": " + difference;
    }
    if (one.published.size() != other.published.size())
        return std::to_string(one.published.size()) + " messages were published against " +
               std::to_string(other.published.size());
    for (const auto& [name, content] : one.files) {
        const auto found = other.files.find(name);
        if (found == other.files.end()) return "the file " + name + " is there only once";
        if (found->second == content) continue;
        const auto at = std::mismatch(content.begin(), content.end(), found->second.begin(), found->second.end()).first;
        return "the file " + name + " from byte " + std::to_string(at - content.begin()) + " on";
    }
    for (const auto& [name, content] : other.files)
        if (one.files.count(name) == 0) return "the file " + name + " is there only once";
    return {};
}

std::string difference_of(const Bytes& one, const Bytes& other) {
    if (one == other) return {};
    std::size_t at = 0;
    while (at < one.size() && at < other.size() && one[at] == other[at]) ++at;
    return "byte " + std::to_string(at) + " of " + std::to_string(one.size()) +
           (one.size() == other.size() ? "" : " (against " + std::to_string(other.size()) + ")");
}

}  // namespace pelorus::conformance
