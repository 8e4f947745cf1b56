// The state of a stage, saved and loaded: what a resumed run rests on.
#include <algorithm>

#include "machine/message_words.hpp"
#include "machine/stage_bench.hpp"

namespace pelorus::conformance {

namespace {

void must_save(const StagePlayer& player) {
    const auto& table = player.instance().table<plr_stage>();
    if ((table.save == nullptr) != (table.load == nullptr))
        FAIL("the stage has " << (table.save == nullptr ? "load" : "save") << " without "
                              << (table.save == nullptr ? "save" : "load"));
    if (table.save == nullptr) skip("the stage keeps no state (save is NULL)");
}

/// A run, as it stood when it was saved.
struct Moment {
    std::size_t step;
    Bytes state;
    std::vector<PublishedMessage> published;
    std::int64_t time;
};

/// Bytes that are no state: nothing, parts of a state, noise.
std::vector<std::pair<std::string, Bytes>> broken_states(const Bytes& state, Sample sample) {
    std::vector<std::pair<std::string, Bytes>> broken{{"no bytes at all", {}}};
    for (const std::size_t size : {std::size_t{1}, state.size() / 4, state.size() / 2, state.size() - 1})
        if (size > 0 && size < state.size())
            broken.emplace_back("its first " + std::to_string(size) + " of " + std::to_string(state.size()) + " bytes",
                                Bytes(state.begin(), state.begin() + static_cast<std::ptrdiff_t>(size)));
    for (const std::size_t size : {std::size_t{8}, state.size(), state.size() + 64}) {
        Bytes noise(size);
        for (unsigned char& byte : noise) byte = static_cast<unsigned char>(sample.below(256));
        broken.emplace_back(std::to_string(size) + " random bytes", noise);
    }
    // A stage may have nothing to save: then no bytes are its whole state.
    broken.erase(std::remove_if(broken.begin(), broken.end(), [&](const auto& each) { return each.second == state; }),
                 broken.end());
    return broken;
}

}  // namespace

PELORUS_CHECK(
    stage, "stage-state-resaves", 3,
    "save answers the same bytes as long as nothing comes in, and a fresh instance that loads them saves them "
    "again, byte for byte; otherwise a snapshot is of another state than the one that runs.",
    {"stage-takes-what-it-asks-for"}) {
    TemporaryFolder folder;
    const Script script = plain_script(bench);
    for (const std::size_t steps : {std::size_t{0}, script.steps() / 2, script.steps()}) {
        folder.clear();
        Bytes state;
        {
            StagePlayer player(bench, in_folder(folder));
            must_save(player);
            play(player, script, 0, steps);
            state = player.save();
            const std::string twice = difference_of(state, player.save());
            if (!twice.empty()) FAIL("after " << steps << " steps, two saves in a row differ at " << twice);
        }
        StagePlayer fresh(bench, in_folder(folder));
        const Answer answer = fresh.load(state);
        if (!answer.is_ok())
            FAIL("load answered " << answer.told << " to the state that another instance saved after " << steps
                                  << " steps");
        const std::string again = difference_of(state, fresh.save());
        if (!again.empty()) FAIL("after " << steps << " steps, what was loaded is saved with another " << again);
    }
}

PELORUS_CHECK(stage, "stage-resumes-bit-for-bit", 3,
              "A run that is saved, ended and loaded into another instance goes on as if nothing had happened: same "
              "messages, same files, same state, to the last bit. A killed run is resumed by it.",
              {"stage-state-resaves", "stage-same-bytes-again"}) {
    const Script script = plain_script(bench);
    const std::size_t n = script.steps();
    StagePlayer undisturbed(bench);
    must_save(undisturbed);
    play(undisturbed, script);
    undisturbed.finish_well();
    const Trace whole = trace_of(undisturbed);

    // Another run saves now and then, goes on, and is ended unfinished.
    TemporaryFolder folder;
    std::vector<Moment> moments;
    Bytes last_state;
    {
        StagePlayer ended(bench, in_folder(folder));
        for (const std::size_t step : {n / 5, n / 2, n - n / 5, n}) {
            play(ended, script, moments.empty() ? 0 : moments.back().step, step);
            moments.push_back({step, ended.save(), ended.published(), ended.time()});
        }
        last_state = moments.back().state;
    }
    for (const Moment& moment : moments) {
        StagePlayer second(bench, in_folder(folder));
        second.set_time(moment.time);
        const Answer answer = second.load(moment.state);
        if (!answer.is_ok()) FAIL("load answered " << answer.told);
        play(second, script, moment.step, n);
        const std::string saved = difference_of(last_state, second.save());
        second.finish_well();
        Trace halves = trace_of(second);
        halves.published.insert(halves.published.begin(), moment.published.begin(), moment.published.end());
        const std::string difference = difference_of(whole, halves);
        const std::string runs =
            "whole, and resumed after step " + std::to_string(moment.step) + " of " + std::to_string(n) + ", runs ";
        if (!difference.empty()) FAIL(runs << "differ: " << difference);
        if (!saved.empty()) FAIL(runs << "end in other states: " << saved);
    }
}

PELORUS_CHECK(stage, "stage-refuses-broken-state", 3,
              "load refuses what is no whole state of its own with PLR_E_DATA or PLR_E_STATE_VERSION: a disk that was "
              "full leaves half of one.",
              {"stage-state-resaves"}) {
    const Script script = plain_script(bench);
    StagePlayer player(bench);
    must_save(player);
    play(player, script, 0, script.steps() / 2);
    for (const auto& [what, bytes] : broken_states(player.save(), bench.sample(2))) {
        const Answer answer = player.load(bytes);
        if (answer.status != PLR_E_DATA && answer.status != PLR_E_STATE_VERSION)
            FAIL("load answered " << answer.told << " to " << what << ", expected PLR_E_DATA or PLR_E_STATE_VERSION");
    }
}

PELORUS_CHECK(stage, "stage-keeps-state-on-refusal", 3,
              "A state that is refused leaves the old one as it was, and the stage goes on with it: load takes all or "
              "nothing.",
              {"stage-refuses-broken-state", "stage-resumes-bit-for-bit"}) {
    const Script script = plain_script(bench);
    const std::size_t half = script.steps() / 2;
    StagePlayer undisturbed(bench), player(bench);
    must_save(player);
    play(undisturbed, script);
    undisturbed.finish_well();
    play(player, script, 0, half);
    const Bytes before = player.save();
    for (const auto& [what, bytes] : broken_states(before, bench.sample(2))) {
        player.load(bytes);
        const std::string difference = difference_of(before, player.save());
        if (!difference.empty()) FAIL("the state has changed after " << what << " were refused: " << difference);
    }
    play(player, script, half, script.steps());
    player.finish_well();
    const std::string difference = difference_of(trace_of(undisturbed), trace_of(player));
    if (!difference.empty()) FAIL("the stage goes on otherwise once broken states were refused: " << difference);
}

PELORUS_CHECK(stage, "stage-survives-flipped-bits", 4,
              "A state of which some bits were flipped is refused, or taken over without a crash then or later: memory "
              "and disks err.",
              {"stage-keeps-state-on-refusal"}) {
    constexpr int tries = 150;
    const Script script = plain_script(bench);
    const std::size_t half = script.steps() / 2;
    StagePlayer player(bench);
    must_save(player);
    play(player, script, 0, half);
    const Bytes good = player.save();
    if (good.empty()) skip("the state has no bytes");
    Sample sample = bench.sample(3);
    int accepted = 0;
    for (int k = 0; k < tries; ++k) {
        Bytes bad = good;
        for (std::uint64_t flips = 1 + sample.below(3); flips > 0; --flips)
            bad[sample.below(bad.size())] ^= static_cast<unsigned char>(1u << sample.below(8));
        const bool is_flipped = bad != good;
        if (!player.load(bad).is_ok()) {
            if (good != player.save()) FAIL("the state has changed although flipped bits were refused");
            continue;
        }
        if (!is_flipped) continue;  // the same bit twice
        ++accepted;
        for (std::size_t i = half; i < std::min(half + 3, script.deliveries.size()); ++i)
            player.receive(script.deliveries[i].port, *script.deliveries[i].message);
        if (!player.load(good).is_ok()) FAIL("a good state is refused after one with flipped bits was taken");
    }
    if (accepted > 0)
        warn("load took " + std::to_string(accepted) + " of " + std::to_string(tries) +
             " states with flipped bits for good; a checksum would tell");
}

}  // namespace pelorus::conformance
