// What schedulers promise: commands that can be obeyed, in time, and none without a reason.
#include <cstring>

#include "machine/message_fields.hpp"
#include "machine/message_words.hpp"
#include "machine/stage_bench.hpp"

namespace pelorus::conformance {

namespace {

/// A scheduler that has seen a feed: what it published, and at which tick.
struct Scheduled {
    Scheduled(const Bench& bench, const FeedOptions& options, Sample sample, std::int32_t status = -1) : player(bench) {
        const Feed feed(bench, player.instance(), sample, options);
        for (const Delivery& delivery : feed.deliveries()) {
            const std::size_t before = player.published().size();
            if (status >= 0 && delivery.message->kind == PLR_MESSAGE_TRACKS)
                deliver_as(delivery, status);
            else
                player.deliver(delivery);
            for (std::size_t i = before; i < player.published().size(); ++i)
                if (player.published()[i].message->kind == PLR_MESSAGE_VALUES)
                    times.push_back(delivery.tick * feed_period);
        }
        for (const PublishedMessage& published : player.published())
            if (published.message->kind == PLR_MESSAGE_VALUES) commands.push_back(published.message);
        commands.resize(times.size());
    }
    template <class Try> void for_each(Try&& attempt) const {
        for (std::size_t i = 0; i < commands.size(); ++i) {
            const plr_values& values = *commands[i]->body.values;
            for (std::uint32_t k = 0; k < values.count; ++k) attempt(element_of(values.quantities, k), times[i]);
        }
    }

    StagePlayer player;
    std::vector<std::shared_ptr<const plr_message>> commands;  ///< messages of values
    std::vector<std::int64_t> times;                           ///< ns, when each was published

private:
    /// The same tracks, all of that status.
    void deliver_as(const Delivery& delivery, std::int32_t status) {
        plr_message message = *delivery.message;
        plr_tracks tracks = *message.body.tracks;
        const std::vector<std::int32_t> all(static_cast<std::size_t>(tracks.count), status);
        tracks.status = all.data();
        message.body.tracks = &tracks;
        const Answer answer = player.receive(delivery.port, message);
        if (!answer.is_ok() && !answer.is_refusal()) FAIL("receive of tracks that have ended answered " << answer.told);
    }
};

FeedOptions quiet(int targets) {
    FeedOptions options;
    options.targets = targets;
    options.clutter = 0;
    options.lives = [](int, std::int64_t) { return true; };
    return options;
}

std::string words(const plr_quantity& quantity) { return std::string("quantity `") + quantity.name + "`"; }

}  // namespace

PELORUS_CHECK(
    scheduler, "scheduler-commands-are-addressed", 3,
    "Every command names a sensor and a quantity, with numbers: a source obeys what is addressed to one of its "
    "sensors, and refuses the rest.",
    {"stage-takes-what-it-asks-for"}) {
    const Scheduled run(bench, quiet(3), bench.sample());
    if (run.commands.empty()) skip("publishes no command for tracks that have positions and velocities");
    run.for_each([](const plr_quantity& quantity, std::int64_t) {
        if (quantity.address == nullptr || quantity.address[0] == 0) FAIL(words(quantity) << " is addressed to nobody");
        if (quantity.name[0] == 0) FAIL("a quantity for " << quantity.address << " has no name");
        const plr_const_view& v = quantity.numbers;
        if (v.rows * v.cols * v.count == 0) FAIL(words(quantity) << " for " << quantity.address << " has no numbers");
    });
}

PELORUS_CHECK(
    scheduler, "scheduler-commands-are-in-time", 3,
    "A command is valid at some time after it was published: a source obeys it at a look that is still to come, "
    "as the feedback edge hands it on strictly later.",
    {"scheduler-commands-are-addressed"}) {
    const Scheduled run(bench, quiet(3), bench.sample());
    run.for_each([](const plr_quantity& quantity, std::int64_t published) {
        if (quantity.valid_to <= published)
            FAIL(words(quantity) << " is valid until " << quantity.valid_to << " ns, and was published at " << published
                                 << " ns: no look can obey it");
    });
}

PELORUS_CHECK(scheduler, "scheduler-quiet-without-tracks", 3,
              "Messages without tracks, and tracks that have ended, are no reason for a command.",
              {"stage-takes-what-it-asks-for"}) {
    const Scheduled none(bench, quiet(0), bench.sample());
    if (!none.commands.empty()) FAIL("no track came in, and it commands: " << brief(*none.commands.front()));
    const Scheduled ended(bench, quiet(3), bench.sample(), PLR_TRACK_DELETED);
    if (!ended.commands.empty())
        FAIL("all tracks are told as DELETED, and it commands: " << brief(*ended.commands.front()));
}

}  // namespace pelorus::conformance
