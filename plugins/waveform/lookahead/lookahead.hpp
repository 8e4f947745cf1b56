/// waveform.lookahead: the pulse that begins the best sequence of several. See README.md.
#pragma once

#include <array>

#include "../../common/waveform/pulse_library.hpp"

namespace lookahead {

using waveform::Covariance;
using waveform::Cross;
using waveform::Noise;
using waveform::Prediction;

class Lookahead : public pelorus::Waveform<Lookahead>, public waveform::LibraryParameters {
public:
    static void describe(pelorus::Describe<Lookahead>& plugin) {
        plugin.title("Pulses several looks ahead")
            .purpose(
                "Searches sequences of pulses, one a look, for the one after which the state will be known best at the "
                "end "
                "of the horizon, and takes its first pulse. A beam search: after each look only the best sequences are "
                "followed up.")
            .equation(
                "P_k+ = P_k - P_k H' (H P_k H' + R)^-1 H P_k; P_k+1 = F P_k+ F' + Q; least criterion of P_h+ over the "
                "pulses R of h looks")
            .source(
                "D. J. Kershaw, R. J. Evans, Optimal waveform selection for tracking systems, IEEE Transactions on "
                "Information Theory 40(5), 1536-1550, 1994 (pulses); B. La Scala, M. Rezaeian, B. Moran, "
                "Optimal adaptive waveform selection for target tracking, FUSION 2005 (several steps)");
        plugin.slot(
            "motion", "motion", 1, 1,
            "F and Q between the looks: a model in the components of the tracker's estimator, without a record");
        plugin.parameter("criterion", &Lookahead::criterion_)
            .initially("determinant")
            .choices(waveform::criteria())
            .doc("what makes a sequence the best, at the end of the horizon");
        plugin.parameter("horizon", &Lookahead::horizon_)
            .initially("2")
            .min(1)
            .max(8)
            .doc("h: looks that are thought of");
        plugin.parameter("beam", &Lookahead::beam_)
            .initially("8")
            .min(1)
            .max(most_beams)
            .doc("how many sequences are followed up after each look");
        describe_library(plugin, "9", "17");
    }

    void setup(const pelorus::Setup& setup) {
        motion_ = setup.part<pelorus::MotionPart>("motion");
        const plr_motion_info& model = motion_.info();
        if (model.record_size > 0 || (model.flags & PLR_MOTION_USES_EXTENT) != 0)
            throw pelorus::PartError("motion",
                                     "its noise depends on a record or an extent, which a prediction has not");
        if (motion_.table().to_cartesian != nullptr)
            throw pelorus::PartError("motion",
                                     "its state is not Cartesian; predictions are told in Cartesian components");
        motion_space_ = pelorus::Space(*model.state);
        if (motion_space_.size() > waveform::most_states)
            throw pelorus::PartError(
                "motion", "has " + std::to_string(motion_space_.size()) + " components, at most 12 are possible");
        for (const waveform::NormalisedPulse& pulse : pulses())
            candidates_.push_back({pulse, waveform::pulse_change(base(), pulse)});
        measurement_ = waveform::measurement_space(dimension);
        space_ = pulse_space();
        info.measurement = measurement_.c();
        info.waveform = space_.c();
        info.horizon = horizon_;
        info.scratch_bytes = model.scratch_bytes + 2 * doubles_of_beams() * sizeof(double) + 4096;
    }

    plr_status choose(const plr_call& call, const plr_waveform_choose& args) const;

    plr_status noise(const plr_call& call, const plr_waveform_noise& args) const {
        return waveform::answer_noise(call, args, measurement_.size(), 2, [&](std::int64_t i) {
            return change(waveform::parameter(args.waveform, i, 0), waveform::parameter(args.waveform, i, 1));
        });
    }

private:
    static constexpr int most_beams = 64;
    struct Candidate {
        waveform::NormalisedPulse pulse;
        waveform::Transform change;
    };
    /// A sequence: the one that it goes on from, its last pulse and its first.
    struct Sequence {
        double criterion = 0;
        int parent = 0;
        std::size_t last = 0, first = 0;  ///< indices of candidates
    };
    /// The best of a look, ascending.
    struct Beam {
        std::array<Sequence, most_beams> sequences{};
        int count = 0;
        void offer(const Sequence& sequence, int room) noexcept {
            if (count == room && !(sequence.criterion < sequences[static_cast<std::size_t>(count - 1)].criterion))
                return;
            int at = count == room ? count - 1 : count++;
            for (; at > 0 && sequence.criterion < sequences[static_cast<std::size_t>(at - 1)].criterion; --at)
                sequences[static_cast<std::size_t>(at)] = sequences[static_cast<std::size_t>(at - 1)];
            sequences[static_cast<std::size_t>(at)] = sequence;
        }
    };
    /// Predicted covariances of the sequences of a beam, in memory of the call.
    using Stored = Eigen::Map<Eigen::MatrixXd>;
    std::uint64_t doubles_of_beams() const noexcept {
        return static_cast<std::uint64_t>(beam_) * waveform::most_states * waveform::most_states;
    }

    Sequence search(const plr_call& call, const plr_waveform_choose& args, std::int64_t i, const Noise& base) const;
    Prediction prediction_from(const plr_waveform_choose& args, std::int64_t i, std::int64_t look,
                               const Covariance& covariance) const;
    Covariance moved(const plr_call& call, const plr_waveform_choose& args, std::int64_t i, std::int64_t look,
                     const Covariance& posterior) const;
    double head_start(const plr_waveform_choose& args, std::int64_t i, std::int64_t look,
                      const Covariance& covariance) const;
    void check_space(const plr_space& cartesian) const;

    waveform::Criterion criterion_ = waveform::Criterion::determinant;
    int horizon_ = 2, beam_ = 8;
    pelorus::MotionPart motion_;
    pelorus::Space motion_space_, measurement_, space_;
    std::vector<Candidate> candidates_;
};

inline plr_status Lookahead::choose(const plr_call& call, const plr_waveform_choose& args) const {
    waveform::check_choose(args, measurement_.size(), 2, horizon_);
    check_space(*args.cartesian);
    if (horizon_ > 1) pelorus::expect(args.dt, horizon_, 1, args.waveform.count, "dt");
    return pelorus::for_items(call, args.waveform.count, [&](std::int64_t i) {
        const Noise base = waveform::load_noise(args.base_noise, i);
        plr_call one = pelorus::slice(call, i);
        one.item_status = nullptr;  // the motion is asked for one item at a time; what it refuses fails this one
        const Sequence best = search(one, args, i, base);
        if (!std::isfinite(best.criterion)) throw pelorus::NumericError("no pulses lead to a finite covariance");
        const Candidate& first = candidates_[best.first];
        Noise noise = base;
        waveform::transform(first.change, base, noise);
        waveform::answer(args, i, std::array<double, 2>{first.pulse.length, first.pulse.chirp}, noise, best.criterion);
    });
}

inline Lookahead::Sequence Lookahead::search(const plr_call& call, const plr_waveform_choose& args, std::int64_t i,
                                             const Noise& base) const {
    const auto c = static_cast<Eigen::Index>(args.covariance.rows);
    const pelorus::Scratch memory(call, static_cast<std::int64_t>(2 * doubles_of_beams()));
    double* now = memory.data();
    double* next = now + doubles_of_beams();
    Beam beam;
    beam.count = 1;  // the prediction that is given
    Stored(now, c, c) = waveform::load_prediction(args, i, 0).covariance;
    for (std::int64_t look = 0; look < horizon_; ++look) {
        Beam best;
        const auto prediction_of = [&](int parent) {
            return prediction_from(args, i, look, Covariance(Stored(now + parent * c * c, c, c)));
        };
        for (int parent = 0; parent < beam.count; ++parent) {
            const Prediction prediction = prediction_of(parent);
            const waveform::Outlook outlook(prediction, base, criterion_);
            const double before = look == 0 ? 0.0 : head_start(args, i, look, prediction.covariance);
            for (std::size_t k = 0; k < candidates_.size(); ++k) {
                const std::size_t first = look == 0 ? k : beam.sequences[static_cast<std::size_t>(parent)].first;
                best.offer({before + outlook(candidates_[k].change), parent, k, first}, beam_);
            }
        }
        for (int n = 0; look + 1 < horizon_ && n < best.count; ++n) {
            const Sequence& sequence = best.sequences[static_cast<std::size_t>(n)];
            Noise noise = base;
            waveform::transform(candidates_[sequence.last].change, base, noise);
            Stored(next + n * c * c, c, c) =
                moved(call, args, i, look, waveform::posterior(prediction_of(sequence.parent), noise));
        }
        std::swap(now, next);
        beam = best;
    }
    return beam.sequences.front();
}

/// How the sensor sees a covariance at a look: as told for the first one; later H' = P^-1 (P H') of what is told there.
inline Prediction Lookahead::prediction_from(const plr_waveform_choose& args, std::int64_t i, std::int64_t look,
                                             const Covariance& covariance) const {
    Prediction told = waveform::load_prediction(args, i, look);
    if (look == 0) return told;
    Covariance root = told.covariance;
    if (!pelorus::small::cholesky(root, root))
        throw pelorus::NumericError("the predicted covariance is not positive definite");
    Cross slope = told.cross;
    pelorus::small::cholesky_solve(root, slope);
    told.covariance = covariance;
    pelorus::small::multiply(covariance, slope, told.cross);
    pelorus::small::Bounded<waveform::most_measured, waveform::most_states> transposed = slope.transpose();
    pelorus::small::symmetric_product(transposed, covariance, told.projected);
    return told;
}

/// What the looks before have done for the criterion: ln(det P/det P without them); nothing for traces, which are what they are.
inline double Lookahead::head_start(const plr_waveform_choose& args, std::int64_t i, std::int64_t look,
                                    const Covariance& covariance) const {
    if (criterion_ == waveform::Criterion::trace || criterion_ == waveform::Criterion::position_trace) return 0;
    Covariance with = covariance, without = waveform::load_prediction(args, i, look).covariance;
    if (!pelorus::small::cholesky(with, with) || !pelorus::small::cholesky(without, without))
        throw pelorus::NumericError("the predicted covariance is not positive definite");
    const double difference = pelorus::small::log_determinant(with) - pelorus::small::log_determinant(without);
    return criterion_ == waveform::Criterion::mutual_information ? difference / 2 : difference;
}

/// F P+ F' + Q from one look to the next.
inline Covariance Lookahead::moved(const plr_call& call, const plr_waveform_choose& args, std::int64_t i,
                                   std::int64_t look, const Covariance& posterior) const {
    const Eigen::Index c = posterior.rows();
    const double dt = args.dt.data[i * args.dt.item_stride + look * args.dt.row_stride];
    pelorus::small::Bounded<waveform::most_states, 1> mean(c, 1), predicted(c, 1);
    for (Eigen::Index k = 0; k < c; ++k)
        mean(k) = args.mean.data[i * args.mean.item_stride + look * args.mean.col_stride + k * args.mean.row_stride];
    Covariance f(c, c), q(c, c);
    auto slope = pelorus::arguments<plr_motion_jacobian>();
    slope.dt = pelorus::const_view(&dt, 1, 1, 1);
    slope.state = pelorus::const_view(mean.data(), c, 1, 1);
    slope.out = pelorus::view(f.data(), c, c, 1);
    pelorus::require(motion_.call(&plr_motion::jacobian, call, slope));
    auto step = pelorus::arguments<plr_motion_propagate>();
    step.dt = slope.dt;
    step.state = slope.state;
    step.out = pelorus::view(predicted.data(), c, 1, 1);
    pelorus::require(motion_.call(&plr_motion::propagate, call, step));
    auto noise = pelorus::arguments<plr_motion_noise>();
    noise.dt = slope.dt;
    noise.state = slope.state;
    noise.covariance = pelorus::const_view(posterior.data(), c, c, 1);
    noise.predicted = pelorus::const_view(predicted.data(), c, 1, 1);
    noise.out = pelorus::view(q.data(), c, c, 1);
    pelorus::require(motion_.call(&plr_motion::noise, call, noise));
    Covariance out(c, c);
    pelorus::small::symmetric_product(f, posterior, out);
    return out + q;
}

inline void Lookahead::check_space(const plr_space& cartesian) const {
    bool same = static_cast<int>(cartesian.size) == motion_space_.size();
    const char* at = reinterpret_cast<const char*>(cartesian.components);
    for (int k = 0; same && k < motion_space_.size(); ++k) {
        const auto& component = *reinterpret_cast<const plr_component*>(at);
        same = motion_space_[k].name == component.name;
        at += component.struct_size;
    }
    if (!same)
        throw pelorus::ArgumentError("cartesian: its components are not those of the motion in slot motion, " +
                                     motion_space_.text());
}

}  // namespace lookahead
