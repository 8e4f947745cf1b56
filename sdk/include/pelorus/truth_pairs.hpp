/// Estimates and truth of the same times, for analyzers: collects both in whatever order they come, and pairs them.
///
///     TruthPairs pairs_;                                                   // member, and part of state()
///     void on_tracks(const Event&, const plr_tracks& tracks) { pairs_.add(tracks); }
///     void on_truth(const Event&, const plr_truth& truth) { pairs_.add(truth); }
///     void finish(const Event&) { for (const auto& [time, instant] : pairs_.instants()) ... instant.pairs() ... }
///
/// Entries meet by equal time stamps (ns). Tracks that are confirmed or coasting count; an entry that is told again replaces the
/// one before. Both sides must stand in one frame, which streams() asks the graph to see to.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pelorus/stage.hpp>

namespace pelorus {

class TruthPairs {
public:
    /// An object or an estimate at one time: its position, then its velocity and acceleration where it has them (m, m/s, m/s2).
    struct Sample {
        std::uint64_t id = 0;
        std::int32_t axes = 0;
        std::vector<double> moments;  ///< axes positions, then axes velocities or none, then axes accelerations or none
        std::vector<double> covariance;  ///< of the moments, by columns; truth: empty
        std::vector<double> extent;      ///< d x d, m^2, by columns; empty: none
        /// How many derivatives the moments tell: 1 (positions) to 3.
        int derivatives() const noexcept { return axes == 0 ? 0 : static_cast<int>(moments.size()) / axes; }
        bool has_velocity() const noexcept { return derivatives() > 1; }
        int extent_dimension() const noexcept { return extent.size() == 9 ? 3 : extent.size() == 4 ? 2 : 0; }
        template <class Archive> void state(Archive& archive) { archive(id, axes, moments, covariance, extent); }
    };
    struct Pair {
        const Sample* estimate;
        const Sample* truth;
    };
    struct Instant {
        std::vector<Sample> truth, estimates;

        /// Each estimate with the object nearest to it.
        std::vector<Pair> pairs() const {
            std::vector<Pair> out;
            if (truth.empty()) return out;
            for (const Sample& estimate : estimates) {
                const auto distance = [&](const Sample& object) {
                    double sum = 0;
                    for (std::size_t k = 0; k < static_cast<std::size_t>(object.axes); ++k)
                        sum += (object.moments[k] - estimate.moments[k]) * (object.moments[k] - estimate.moments[k]);
                    return sum;
                };
                out.push_back(
                    {&estimate, &*std::min_element(truth.begin(), truth.end(), [&](const auto& a, const auto& b) {
                         return distance(a) < distance(b);
                     })});
            }
            return out;
        }
        /// Objects that no estimate is nearest to.
        std::int64_t missing() const {
            const std::vector<Pair> all = pairs();
            return std::count_if(truth.begin(), truth.end(), [&](const Sample& object) {
                return std::none_of(all.begin(), all.end(), [&](const Pair& pair) { return pair.truth == &object; });
            });
        }
        template <class Archive> void state(Archive& archive) { archive(truth, estimates); }
    };

    /// What the ports `tracks` and `truth` of an analyzer in `frame` take: anything that tells positions there.
    static std::vector<Stream> streams(const std::string& frame) {
        Stream stream;
        stream.any_sensor = true;
        stream.space = position_space(1);
        stream.frame = frame;
        stream.at_least = true;
        return {stream};
    }

    void add(const plr_tracks& tracks) {
        const Layout layout(*tracks.space, "tracks");
        agree(layout);
        for (std::int64_t i = 0; i < tracks.count; ++i) {
            if (tracks.status[i] != PLR_TRACK_CONFIRMED && tracks.status[i] != PLR_TRACK_COASTING) continue;
            Sample sample = layout.sample(tracks.ids[i], tracks.mean, tracks.extent, i);
            for (const int col : layout.components)
                for (const int row : layout.components)
                    sample.covariance.push_back(element(tracks.covariance, i, row, col));
            put(instants_[tracks.times[i]].estimates, std::move(sample));
            ids_.insert(tracks.ids[i]);
        }
    }
    void add(const plr_truth& truth) {
        const Layout layout(*truth.space, "truth");
        agree(layout);
        for (std::int64_t i = 0; i < truth.count; ++i)
            put(instants_[truth.times[i]].truth, layout.sample(truth.ids[i], truth.state, truth.extent, i));
    }

    /// By time (ns). Instants without truth are those of estimates that nothing can be compared with.
    const std::map<std::int64_t, Instant>& instants() const noexcept { return instants_; }
    /// Axes that positions have; 0 before the first message.
    std::int32_t axes() const noexcept { return axes_; }
    /// How many different tracks were confirmed.
    std::size_t track_count() const noexcept { return ids_.size(); }

    template <class Archive> void state(Archive& archive) { archive(axes_, instants_, ids_); }

private:
    /// Where positions, velocities and accelerations stand in a space.
    struct Layout {
        std::vector<int> components;
        std::int32_t axes = 0;
        const char* what;

        /// Made for every message, so without copying the space.
        Layout(const plr_space& raw, const char* what_) : what(what_) {
            std::array<std::array<int, 3>, 3> place;  // derivative, axis; -1: the space has none
            for (auto& of_axes : place) of_axes.fill(-1);
            const char* at = reinterpret_cast<const char*>(raw.components);
            for (std::uint32_t k = 0; k < raw.size; ++k) {
                const auto& component = *reinterpret_cast<const plr_component*>(at);
                at += component.struct_size;
                const auto [derivative, axis] = place_of(component.name);
                if (derivative < 3 && place[derivative][axis] < 0) place[derivative][axis] = static_cast<int>(k);
            }
            components.reserve(9);
            for (const auto& of_axes : place) {
                const auto found = static_cast<std::int32_t>(
                    std::count_if(of_axes.begin(), of_axes.end(), [](int index) { return index >= 0; }));
                if (axes == 0) {
                    axes = found;
                    if (axes == 0) throw DataError(std::string(what) + " tell no position: " + Space(raw).text());
                } else if (found != axes) {
                    break;  // no velocity (acceleration), or not of all axes
                }
                for (const int index : of_axes)
                    if (index >= 0) components.push_back(index);
            }
        }
        /// The derivative and the axis of a component's name; derivative 3: it is neither position nor velocity nor acceleration.
        static std::pair<std::size_t, std::size_t> place_of(std::string_view name) noexcept {
            constexpr std::string_view derivatives[] = {"position.", "velocity.", "acceleration."};
            for (std::size_t d = 0; d < 3; ++d) {
                const std::size_t length = derivatives[d].size();
                if (name.size() != length + 1 || name.substr(0, length) != derivatives[d]) continue;
                if (name.back() >= 'x' && name.back() <= 'z') return {d, static_cast<std::size_t>(name.back() - 'x')};
            }
            return {3, 0};
        }
        Sample sample(std::uint64_t id, const plr_const_view& mean, const plr_const_view& extent,
                      std::int64_t i) const {
            Sample out;
            out.id = id;
            out.axes = axes;
            for (const int k : components) out.moments.push_back(element(mean, i, k, 0));
            if (extent.data != nullptr)
                for (std::int64_t col = 0; col < extent.cols; ++col)
                    for (std::int64_t row = 0; row < extent.rows; ++row)
                        out.extent.push_back(element(extent, i, row, col));
            return out;
        }
    };

    static double element(const plr_const_view& view, std::int64_t i, std::int64_t row, std::int64_t col) {
        return view.data[i * view.item_stride + col * view.col_stride + row * view.row_stride];
    }
    void agree(const Layout& layout) {
        if (axes_ == 0) axes_ = layout.axes;
        if (axes_ != layout.axes)
            throw ArgumentError(std::string(layout.what) + " have positions on " + std::to_string(layout.axes) +
                                " axes, what came before on " + std::to_string(axes_));
    }
    static void put(std::vector<Sample>& to, Sample sample) {
        const auto same = std::find_if(to.begin(), to.end(), [&](const Sample& s) { return s.id == sample.id; });
        if (same == to.end())
            to.push_back(std::move(sample));
        else
            *same = std::move(sample);
    }

    std::int32_t axes_ = 0;
    std::map<std::int64_t, Instant> instants_;
    std::set<std::uint64_t> ids_;
};

}  // namespace pelorus
