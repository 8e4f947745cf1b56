// The calls around a filter's step: start, moments, assignment, and the mixture of hypotheses.
#include "factors.hpp"
#include "filter.hpp"

namespace gaussian {

using pelorus::NumericError;
using pelorus::Scratch;

namespace {

using Square = small::Bounded<max_state, max_state>;
using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, max_state, 1>;

}  // namespace

/// A covariance becomes its factor where that is what records hold.
void Filter::factorise(double* spread) const {
    if (form_ == Form::covariance) return;
    Eigen::Map<Square> p(spread, n_, n_);
    if (!small::cholesky_semidefinite(p, p)) throw NumericError(text(Outcome::covariance_indefinite));
}

void Filter::covariance_of(const double* spread, double* out) const noexcept {
    if (form_ == Form::covariance)
        std::copy_n(spread, n_ * n_, out);
    else
        small::gram(Eigen::Map<const Square>(spread, n_, n_), Eigen::Map<Square>(out, n_, n_));
}

plr_const_view Filter::covariances(const plr_const_view& records, double* memory) const noexcept {
    if (form_ == Form::covariance) return spread(records);
    const plr_view out = pelorus::view(memory, n_, n_, records.count);
    for (std::int64_t i = 0; i < records.count; ++i) covariance_of(at(records, i) + n_, at(out, i));
    return pelorus::as_const(out);
}

plr_status Filter::init(const plr_call& call, const plr_estimator_init& args) const {
    const std::int64_t known = args.known, count = args.record.count;
    for (std::int64_t k = 0; k < known; ++k) {
        if (args.components[k] < (k == 0 ? 0 : args.components[k - 1] + 1) || args.components[k] >= c_)
            throw pelorus::ArgumentError("components: are not ascending indices below " + std::to_string(c_));
    }
    expect_packed(args.mean, known, 1, count, "mean");
    expect_packed(args.covariance, known, known, count, "covariance");
    expect_packed(args.record, record_size_, 1, count, "record");

    const std::int64_t doubles = state_is_cartesian_ ? 0 : c_ + c_ * c_ + n_ * c_;
    const Scratch scratch(call, block_size * doubles);
    return in_blocks(call, count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_view records = pelorus::slice(args.record, first, items);
        // Cartesian moments: those of the record where the state is Cartesian, else of their own. The record holds
        // covariances until the motion has seen them.
        double* const memory = scratch.data();
        const plr_view means = state_is_cartesian_ ? field(records, 0, c_, 1) : pelorus::view(memory, c_, 1, items);
        const plr_view covariances =
            state_is_cartesian_ ? field(records, n_, c_, c_) : pelorus::view(memory + block_size * c_, c_, c_, items);
        const plr_status started = for_good_items(
            block, items, [&](std::int64_t i) { start_item(args, first + i, at(means, i), at(covariances, i)); });
        if (started < 0) return started;
        if (!state_is_cartesian_)
            from_cartesian(block, pelorus::as_const(means), pelorus::as_const(covariances), records,
                           memory + block_size * (c_ + c_ * c_));
        if (motion_record_ > 0) {
            auto start = pelorus::arguments<plr_motion_record>();
            start.state = mean(pelorus::as_const(records));
            start.covariance = spread(pelorus::as_const(records));
            start.out = motion_record(records);
            tolerate(motion_.call(&plr_motion::init_record, block, start));
        }
        return for_good_items(block, items, [&](std::int64_t i) { factorise(at(records, i) + n_); });
    });
}

/// Cartesian moments of one item: what is given, and priors for the rest.
void Filter::start_item(const plr_estimator_init& args, std::int64_t item, double* x, double* p) const {
    const std::int64_t known = args.known;
    std::fill_n(p, c_ * c_, 0.0);
    for (int k = 0; k < cartesian_.size(); ++k) {
        x[k] = cartesian_[k].prior_mean;
        p[k * c_ + k] = cartesian_[k].prior_deviation * cartesian_[k].prior_deviation;
    }
    const double* const given = at(args.mean, item);
    const double* const spread = at(args.covariance, item);
    for (std::int64_t a = 0; a < known; ++a) {
        x[args.components[a]] = given[a];
        for (std::int64_t b = 0; b < known; ++b)
            p[args.components[b] * c_ + args.components[a]] = 0.5 * (spread[b * known + a] + spread[a * known + b]);
    }
    if (!all_finite(x, c_) || !all_finite(p, c_ * c_))
        throw NumericError("the mean or covariance to start from is not finite");
}

/// Moments of the state from Cartesian ones. A component of the state that no Cartesian one tells of (a turn rate, say) enters
/// with its prior deviation.
void Filter::from_cartesian(const plr_call& call, const plr_const_view& means, const plr_const_view& covariances,
                            const plr_view& records, double* jacobian) const {
    auto convert = pelorus::arguments<plr_motion_convert>();
    convert.in = means;
    convert.out = mean(records);
    convert.jacobian = pelorus::view(jacobian, n_, c_, records.count);
    tolerate(motion_.call(&plr_motion::from_cartesian, call, convert));
    tolerate(for_good_items(call, records.count, [&](std::int64_t i) {
        const Eigen::Map<const Square> j(at(convert.jacobian, i), n_, c_);
        Eigen::Map<Square> p(at(spread(records), i), n_, n_);
        small::symmetric_product(j, Eigen::Map<const Square>(at(covariances, i), c_, c_), p);
        for (int r = 0; r < state_.size(); ++r) {
            bool told = false;
            for (std::int64_t k = 0; k < c_; ++k) told = told || j.data()[k * n_ + r] != 0.0;
            if (!told) p.data()[r * n_ + r] = state_[r].prior_deviation * state_[r].prior_deviation;
        }
        if (!small::all_finite(p)) throw NumericError(text(Outcome::not_finite));
    }));
}

plr_status Filter::summary(const plr_call& call, const plr_estimator_moments& args) const {
    if (state_is_cartesian_) return moments(call, args);
    const std::int64_t count = args.mean.count;
    const bool wanted = args.covariance.data != nullptr;
    expect_packed(args.record, record_size_, 1, count, "record");
    expect_packed(args.mean, c_, 1, count, "mean");
    if (wanted) expect_packed(args.covariance, c_, c_, count, "covariance");
    const Scratch scratch(call, block_size * (c_ * n_ + n_ * n_));
    return in_blocks(call, count, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_const_view records = pelorus::slice(args.record, first, items);
        auto convert = pelorus::arguments<plr_motion_convert>();
        convert.in = mean(records);
        convert.out = pelorus::slice(args.mean, first, items);
        if (wanted) convert.jacobian = pelorus::view(scratch.data(), c_, n_, items);
        tolerate(motion_.call(&plr_motion::to_cartesian, block, convert));
        const plr_const_view own = covariances(records, scratch.data() + block_size * c_ * n_);
        return for_good_items(block, items, [&](std::int64_t i) {
            if (!wanted) return;
            Eigen::Map<Square> out(at(args.covariance, first + i), c_, c_);
            small::symmetric_product(Eigen::Map<const Square>(at(convert.jacobian, i), c_, n_),
                                     Eigen::Map<const Square>(at(own, i), n_, n_), out);
            if (!small::all_finite(out)) throw NumericError(text(Outcome::not_finite));
        });
    });
}

plr_status Filter::moments(const plr_call& call, const plr_estimator_moments& args) const {
    const std::int64_t count = args.mean.count;
    expect_packed(args.record, record_size_, 1, count, "record");
    expect_packed(args.mean, n_, 1, count, "mean");
    if (args.covariance.data != nullptr) expect_packed(args.covariance, n_, n_, count, "covariance");
    return pelorus::for_items(call, count, [&](std::int64_t i) {
        const double* const record = at(args.record, i);
        std::copy_n(record, n_, at(args.mean, i));
        bool is_finite = all_finite(record, n_);
        if (args.covariance.data != nullptr) {
            double* const out = at(args.covariance, i);
            covariance_of(record + n_, out);
            is_finite = is_finite && all_finite(out, n_ * n_);
        }
        if (!is_finite) throw NumericError(text(Outcome::not_finite));
    });
}

plr_status Filter::assign(const plr_call& call, const plr_estimator_assign& args) const {
    const std::int64_t count = args.out.count;
    expect_packed(args.record, record_size_, 1, count, "record");
    expect_packed(args.mean, n_, 1, count, "mean");
    expect_packed(args.covariance, n_, n_, count, "covariance");
    expect_packed(args.out, record_size_, 1, count, "out");
    return pelorus::for_items(call, count, [&](std::int64_t i) {
        Square p = Eigen::Map<const Square>(at(args.covariance, i), n_, n_);
        small::symmetrise(p);
        if (!all_finite(at(args.mean, i), n_) || !small::all_finite(p))
            throw NumericError("the mean or covariance to assign is not finite");
        factorise(p.data());
        double* const out = at(args.out, i);
        std::copy_n(at(args.mean, i), n_, out);
        std::copy_n(p.data(), n_ * n_, out + n_);
        std::copy_n(at(args.record, i) + n_ + n_ * n_, motion_record_, out + n_ + n_ * n_);
    });
}

plr_status Filter::mix(const plr_call& call, const plr_estimator_mix_args& args) const {
    const std::int64_t count = args.out.count, hypotheses = args.weights.rows;
    expect_packed(args.weights, hypotheses, 1, count, "weights");
    expect_packed(args.records, record_size_, hypotheses, count, "records");
    expect_packed(args.out, record_size_, 1, count, "out");
    return pelorus::for_items(call, count, [&](std::int64_t i) { mix_item(args, i); });
}

/// Mean and covariance of the mixture; angles are averaged about the likeliest hypothesis, which also gives the motion's
/// record.
void Filter::mix_item(const plr_estimator_mix_args& args, std::int64_t item) const {
    const double* const weights = at(args.weights, item);
    const std::int64_t hypotheses = args.weights.rows;
    double total = 0.0;
    std::int64_t likeliest = 0;
    for (std::int64_t k = 0; k < hypotheses; ++k) {
        if (!(weights[k] >= 0.0)) throw NumericError("a weight is negative or not a number");
        total += weights[k];
        if (weights[k] > weights[likeliest]) likeliest = k;
    }
    if (!(std::fabs(total - 1.0) < 1e-9)) throw NumericError("the weights do not sum to 1");

    const double* const records = at(args.records, item);
    const double* const centre = records + likeliest * record_size_;
    Column shift = Column::Zero(n_, 1), mean(n_, 1), difference(n_, 1);
    for (std::int64_t k = 0; k < hypotheses; ++k) {
        const double* const x = records + k * record_size_;
        for (std::int64_t r = 0; r < n_; ++r) difference.data()[r] = x[r] - centre[r];
        wrap(difference.data());
        for (std::int64_t r = 0; r < n_; ++r) shift.data()[r] += weights[k] * difference.data()[r];
    }
    for (std::int64_t r = 0; r < n_; ++r) mean.data()[r] = centre[r] + shift.data()[r];
    wrap(mean.data());

    Square spread = Square::Zero(n_, n_);
    if (form_ == Form::covariance)
        mix_covariances(weights, records, hypotheses, mean.data(), spread.data());
    else
        mix_factors(weights, records, hypotheses, mean.data(), spread.data());
    if (!small::all_finite(mean) || !small::all_finite(spread)) throw NumericError(text(Outcome::not_finite));
    double* const out = at(args.out, item);
    std::copy_n(mean.data(), n_, out);
    std::copy_n(spread.data(), n_ * n_, out + n_);
    std::copy_n(centre + n_ + n_ * n_, motion_record_, out + n_ + n_ * n_);
}

/// out += the sum of w (P + d d'), d = x - mean.
void Filter::mix_covariances(const double* weights, const double* records, std::int64_t hypotheses, const double* mean,
                             double* out) const {
    Column difference(n_, 1);
    for (std::int64_t k = 0; k < hypotheses; ++k) {
        const double* const record = records + k * record_size_;
        for (std::int64_t e = 0; e < n_ * n_; ++e) out[e] += weights[k] * record[n_ + e];
        for (std::int64_t r = 0; r < n_; ++r) difference.data()[r] = record[r] - mean[r];
        wrap(difference.data());
        small::add_outer(weights[k], difference, Eigen::Map<Square>(out, n_, n_));
    }
}

/// The factor of the same.
void Filter::mix_factors(const double* weights, const double* records, std::int64_t hypotheses, const double* mean,
                         double* out) const {
    const int n = static_cast<int>(n_);
    for (std::int64_t k = 0; k < hypotheses; ++k) {
        const double* const record = records + k * record_size_;
        const double root = std::sqrt(weights[k]);
        double columns[max_state * (max_state + 1)];
        for (std::int64_t e = 0; e < n_ * n_; ++e) columns[e] = root * record[n_ + e];
        double* const difference = columns + n_ * n_;
        for (std::int64_t r = 0; r < n_; ++r) difference[r] = record[r] - mean[r];
        wrap(difference);
        for (std::int64_t r = 0; r < n_; ++r) difference[r] *= root;
        append_columns<0, max_state>(n, out, columns, n + 1);
    }
}

}  // namespace gaussian
