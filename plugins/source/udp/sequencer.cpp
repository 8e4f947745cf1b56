#include "sequencer.hpp"

#include <algorithm>
#include <utility>

#include <pelorus/failure.hpp>

namespace source_udp {

namespace {

constexpr std::size_t most_ranges = 256;  // of given-up numbers that a sender's late datagrams are told by

std::string name_of(const std::pair<std::string, std::uint64_t>& key) {
    return key.second == 0 ? "sender " + key.first
                           : "sender " + key.first + " (session " + std::to_string(key.second) + ")";
}

std::string range_text(std::uint64_t first, std::uint64_t last) {
    if (first == last) return "datagram " + std::to_string(first) + " is";
    return "datagrams " + std::to_string(first) + " to " + std::to_string(last) + " are";
}

std::string seconds_text(std::int64_t time) {
    char text[40];
    std::snprintf(text, sizeof text, "%.3f s", static_cast<double>(time) * 1e-9);
    return text;
}

/// Takes a number out of a set of ranges; false: it is in none.
bool remove(std::map<std::uint64_t, std::uint64_t>& ranges, std::uint64_t number) {
    auto found = ranges.upper_bound(number);
    if (found == ranges.begin()) return false;
    --found;
    const auto [first, last] = *found;
    if (number > last) return false;
    ranges.erase(found);
    if (first < number) ranges[first] = number - 1;
    if (number < last) ranges[number + 1] = last;
    return true;
}

/// The oldest are forgotten: what comes of them is a duplicate then.
void keep_newest(std::map<std::uint64_t, std::uint64_t>& ranges) {
    while (ranges.size() > most_ranges) ranges.erase(ranges.begin());
}

}  // namespace

wire::Frame Sequencer::take() {
    wire::Frame frame = std::move(ready_.front());
    ready_.pop_front();
    ready_bytes_ -= frame.bytes();
    return frame;
}

/// Room for one more sender is made by forgetting who has ended, longest ago first.
Sequencer::Flow* Sequencer::flow_of(const Key& key) {
    const auto found = flows_.find(key);
    if (found != flows_.end()) return &found->second;
    if (flows_.size() >= settings_.maximum_senders) {
        // What has ended makes room, and earlier starts of the same sender do: it may be restarted as often as it likes.
        auto oldest = flows_.end();
        for (auto at = flows_.begin(); at != flows_.end(); ++at)
            if ((at->second.ended || at->first.first == key.first) &&
                (oldest == flows_.end() || at->second.heard < oldest->second.heard))
                oldest = at;
        if (oldest == flows_.end()) return nullptr;
        while (!oldest->second.held.empty()) give_up_next(oldest->first, oldest->second);
        waiting_bytes_ -= oldest->second.bytes();
        flows_.erase(oldest);
    }
    return &flows_[key];
}

bool Sequencer::push(wire::Datagram datagram, std::int64_t now) {
    const Key key{datagram.sender, datagram.session};
    Flow* flow = flow_of(key);
    if (flow == nullptr) return false;
    flow->heard = ++heard_;
    if (datagram.sequence)
        order(key, *flow, std::move(datagram), now);
    else
        release(key, *flow, datagram, false);
    make_room();
    return true;
}

/// Who has most waiting gives up first, so that one sender cannot make the others lose.
void Sequencer::make_room() {
    while (waiting_bytes_ > settings_.maximum_waiting) {
        auto& [key, flow] = *std::max_element(flows_.begin(), flows_.end(), [](const auto& a, const auto& b) {
            return a.second.bytes() < b.second.bytes();
        });
        if (flow.held.empty())
            incomplete(key, flow, " before too much was waiting (maximum_pending)");
        else
            give_up_next(key, flow);
    }
}

bool Sequencer::hold(Flow& flow, std::uint64_t sequence, wire::Datagram datagram) {
    const auto [held, added] = flow.held.try_emplace(sequence, std::move(datagram));
    if (!added) return false;
    const std::size_t bytes = held->second.bytes();
    flow.held_bytes += bytes, waiting_bytes_ += bytes;
    return true;
}

wire::Datagram Sequencer::take_held(Flow& flow) {
    wire::Datagram datagram = std::move(flow.held.begin()->second);
    flow.held.erase(flow.held.begin());
    const std::size_t bytes = datagram.bytes();
    flow.held_bytes -= bytes, waiting_bytes_ -= bytes;
    return datagram;
}

void Sequencer::order(const Key& key, Flow& flow, wire::Datagram datagram, std::int64_t now) {
    const std::uint64_t sequence = *datagram.sequence;
    if (!flow.next) {
        // The first ones may come in the wrong order; a number far from 0 is of somebody who has long been sending.
        flow.next = sequence <= settings_.reorder_datagrams ? 0 : sequence;
        if (*flow.next != 0)
            warn_(name_of(key) + " is heard from datagram " + std::to_string(sequence) +
                  " on; those before are not counted");
    }
    if (sequence < *flow.next) return past(key, flow, datagram, sequence);
    if (sequence > *flow.next) {
        if (!hold(flow, sequence, std::move(datagram))) return duplicate(key, sequence, "; one of them is left out");
        if (!flow.waiting_since) flow.waiting_since = now;
        while (flow.held.size() > settings_.reorder_datagrams) give_up_next(key, flow);
        return;
    }
    release(key, flow, datagram, false);
    ++*flow.next;
    advance(key, flow);
}

/// A datagram whose number was passed: given up before, or seen before.
void Sequencer::past(const Key& key, Flow& flow, const wire::Datagram& datagram, std::uint64_t sequence) {
    if (sequence == flow.end) return;  // an end is told several times, so that one of them comes through
    const std::string which = name_of(key) + ": datagram " + std::to_string(sequence);
    if (!remove(flow.given_up, sequence)) {
        duplicate(key, sequence, settings_.duplicates == Duplicates::drop ? "; it is left out" : "");
        if (settings_.duplicates == Duplicates::keep) release(key, flow, datagram, true);
        return;
    }
    keep_newest(flow.given_up);  // taking one out of a range makes two of it
    --counts_.lost;
    ++counts_.late;
    if (settings_.late == Late::stop)
        throw pelorus::DataError(which + " came after it had been given up (late: drop or keep would go on)");
    warn_(which + " came after it had been given up" + (settings_.late == Late::drop ? "; it is left out" : ""));
    if (settings_.late == Late::keep) release(key, flow, datagram, true);
}

void Sequencer::duplicate(const Key& key, std::uint64_t sequence, const char* outcome) {
    ++counts_.duplicate;
    warn_(name_of(key) + ": datagram " + std::to_string(sequence) + " came again" + outcome);
}

/// Goes on with the next datagram that is there.
void Sequencer::give_up_next(const Key& key, Flow& flow) {
    const std::uint64_t first = *flow.next, last = flow.held.begin()->first - 1;
    counts_.lost += last - first + 1;
    const std::string text = name_of(key) + ": " + range_text(first, last) + " lost";
    if (settings_.lost == Lost::stop) throw pelorus::DataError(text + " (lost: count would go on)");
    warn_(text);
    flow.given_up[first] = last;
    keep_newest(flow.given_up);
    flow.next = last + 1;
    advance(key, flow);
}

/// Releases what waits and is due now.
void Sequencer::advance(const Key& key, Flow& flow) {
    if (flow.held.empty() || flow.held.begin()->first != *flow.next) return;
    while (!flow.held.empty() && flow.held.begin()->first == *flow.next) {
        release(key, flow, take_held(flow), false);
        ++*flow.next;
    }
    flow.waiting_since.reset();  // what still waits, waits for another one: its time begins at the next look
}

void Sequencer::expire(std::int64_t now) {
    for (auto& [key, flow] : flows_) {
        if (flow.held.empty()) continue;
        if (!flow.waiting_since) flow.waiting_since = now;
        if (now - *flow.waiting_since >= settings_.reorder_time) give_up_next(key, flow);
    }
}

void Sequencer::flush() {
    for (auto& [key, flow] : flows_)
        while (!flow.held.empty()) give_up_next(key, flow);
}

void Sequencer::release(const Key& key, Flow& flow, const wire::Datagram& datagram, bool known_late) {
    for (const wire::Frame& frame : datagram.frames) {
        if (frame.kind == wire::Kind::end) {
            if (!flow.ended) ++ended_;
            flow.ended = true;
            flow.end = datagram.sequence;
        } else {
            release(key, flow, frame, known_late);
        }
    }
}

void Sequencer::release(const Key& key, Flow& flow, const wire::Frame& frame, bool known_late) {
    if (frame.kind == wire::Kind::tracks || (frame.kind == wire::Kind::truth && frame.width == 0)) {
        ++counts_.ignored;
    } else if (frame.part[1] == 1) {
        if (!known_late) incomplete(key, flow);
        enqueue(key, frame, known_late);
    } else if (known_late) {
        ++counts_.incomplete;
        warn_(name_of(key) + ": a part of the frame at " + seconds_text(frame.time) +
              " came too late to be put together with the others; it is left out");
    } else {
        put_together(key, flow, frame);
    }
}

void Sequencer::put_together(const Key& key, Flow& flow, const wire::Frame& part) {
    const std::size_t bytes = part.bytes();
    const bool fits = flow.whole && flow.whole->rows() + part.rows() <= settings_.maximum_measurements &&
                      flow.whole_bytes + bytes <= settings_.maximum_waiting;
    if (part.part[0] == 1) {
        incomplete(key, flow);
        flow.whole = part;
    } else if (!fits || !append(*flow.whole, part)) {
        forget_whole(flow);
        if (flow.broken == part.time) return;  // said and counted once a frame
        flow.broken = part.time;
        ++counts_.incomplete;
        warn_(name_of(key) + ": the frame at " + seconds_text(part.time) + " cannot be put together from its " +
              std::to_string(part.part[1]) + " parts; it is left out");
        return;
    }
    const std::size_t added = bytes - (part.part[0] == 1 ? 0 : sizeof part);
    flow.whole_bytes += added, waiting_bytes_ += added;
    if (flow.whole->part[0] != flow.whole->part[1]) return;
    wire::Frame whole = std::move(*flow.whole);
    forget_whole(flow);
    enqueue(key, std::move(whole), false);
}

void Sequencer::forget_whole(Flow& flow) {
    flow.whole.reset();
    waiting_bytes_ -= std::exchange(flow.whole_bytes, 0);
}

/// Parts whose others have not come before something else did.
void Sequencer::incomplete(const Key& key, Flow& flow, const char* before) {
    if (!flow.whole) return;
    ++counts_.incomplete;
    warn_(name_of(key) + ": of the frame at " + seconds_text(flow.whole->time) + " only " +
          std::to_string(flow.whole->part[0]) + " of " + std::to_string(flow.whole->part[1]) + " parts came" + before +
          "; it is left out");
    flow.broken = flow.whole->time;
    forget_whole(flow);
}

void Sequencer::enqueue(const Key& key, wire::Frame frame, bool known_late) {
    const std::int64_t arrival = frame.arrival.value_or(frame.time);
    if (newest_ && arrival < *newest_) {
        if (!known_late && !settings_.own_clock) {
            ++counts_.late;
            const std::string text = name_of(key) + ": the frame that arrived at " + seconds_text(arrival) +
                                     " comes after one that arrived at " + seconds_text(*newest_);
            if (settings_.late == Late::stop) throw pelorus::DataError(text + " (late: drop or keep would go on)");
            warn_(text + (settings_.late == Late::drop ? "; it is left out" : ""));
            if (settings_.late == Late::drop) return;
        }
        frame.arrival = newest_;
    } else {
        frame.arrival = newest_ = arrival;
    }
    ready_bytes_ += frame.bytes();
    ready_.push_back(std::move(frame));
}

}  // namespace source_udp
