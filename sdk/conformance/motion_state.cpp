// What a motion promises of points, of special states, of its record and of the way to Cartesian components and back.
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "differences.hpp"
#include "machine/library.hpp"
#include "motion_trial.hpp"

namespace pelorus::conformance {

namespace {

constexpr std::int64_t batch = 4;

void require_same(const std::string& what, const Eigen::VectorXd& got, const Eigen::VectorXd& expected,
                  const Eigen::VectorXd& scales, const Space& space) {
    const std::string off =
        first_difference(got, expected, Eigen::VectorXd(1e-13 * (expected.cwiseAbs() + scales)), space);
    if (!off.empty()) FAIL(what << ": " << off);
}

/// Every point of a call with several, against a call with that point alone.
void compare_points(const MotionTrial& trial, const HotCall& call, const Space& space, const Eigen::VectorXd& scales,
                    const std::function<HotCall(const Argument& point)>& alone) {
    const Execution together = execute_well(*trial.instance, call);
    const Argument& points = call.in[call.in.size() == 1 ? 0 : 1];
    for (std::int64_t p = 0; p < points.cols; ++p) {
        const Argument point = input(points.name, points.rows, 1, call.count, [&](double* out, std::int64_t i) {
            Eigen::Map<Eigen::VectorXd>(out, points.rows) = item(points, i).col(p);
        });
        const HotCall single_call = alone(point);
        const Execution single = execute_well(*trial.instance, single_call);
        for (std::int64_t i = 0; i < call.count; ++i) {
            if (together.failed(i) || single.failed(i)) continue;
            require_same(fmt::format("{}: point {} of item {}, among {} and alone", call.function, p, i, points.cols),
                         item_matrix(call, together, 0, i).col(p), item_matrix(single_call, single, 0, i).col(0),
                         scales, space);
        }
    }
}

Argument points_about(MotionTrial& trial, const MotionItems& items, std::int64_t points) {
    return input("state", trial.n, points, items.count, [&](double* out, std::int64_t i) {
        for (std::int64_t p = 0; p < points; ++p)
            for (Eigen::Index r = 0; r < trial.n; ++r)
                out[p * trial.n + r] = item(items.state, i)(r, 0) + 0.05 * trial.scales(r) * trial.sample.normal();
    });
}

/// The calls that a state is handed to.
std::vector<HotCall> calls_at(MotionTrial& trial, const Eigen::VectorXd& dt, const MotionItems& items) {
    using namespace motion_calls;
    return {propagate(*trial.instance, steps(dt), items.state, items.record, absent("mean")),
            jacobian(*trial.instance, steps(dt), items.state, items.record, absent("mean")),
            noise(*trial.instance, steps(dt), items.state, items.covariance, renamed(items.state, "predicted"),
                  items.extent, items.record)};
}

/// A distance that is no coordinate of a place: at 0 the other coordinates are not defined, or infinite.
bool may_refuse_zero(const Component& component) {
    return (component.unit == "m" || component.unit == "1/m") && component.name.compare(0, 9, "position.") != 0;
}

/// Leaves out the states that the motion refuses by item and may: those with a distance of 0.
void drop_refused(MotionTrial& trial, Eigen::MatrixXd& at, std::vector<std::string>& titles) {
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < at.cols(); ++i) {
        bool may_refuse = false, is_refused = false;
        for (Eigen::Index r = 0; r < trial.n; ++r)
            may_refuse = may_refuse || (at(r, i) == 0 && may_refuse_zero(trial.state[static_cast<int>(r)]));
        if (may_refuse) {
            const MotionItems one = trial.items_at(at.col(i));
            const Eigen::VectorXd dt = Eigen::VectorXd::Constant(1, trial.sample.step());
            for (const HotCall& call : calls_at(trial, dt, one))
                is_refused = is_refused || execute(*trial.instance, call).failed(0);
        }
        if (!is_refused) kept.push_back(i);
    }
    for (std::size_t k = 0; k < kept.size(); ++k) {
        at.col(static_cast<Eigen::Index>(k)) = at.col(kept[k]);
        titles[k] = titles[static_cast<std::size_t>(kept[k])];
    }
    at.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(kept.size()));
    titles.resize(kept.size());
}

}  // namespace

PELORUS_CHECK(motion, "motion-points-equal-singles", 3,
              "Of several points of one item, each is moved as it would be alone with the same mean; where no mean is "
              "given the state is it. Sigma-point filters hand all points over in one call.",
              {"numbers-finite"}) {
    MotionTrial trial(bench);
    const MotionItems items = trial.draw(batch);
    const Eigen::VectorXd dt = trial.drawn_steps(batch);
    using namespace motion_calls;
    const Argument points = points_about(trial, items, 4);
    compare_points(trial, motion_calls::propagate(*trial.instance, steps(dt), points, items.record, items.state),
                   trial.state, trial.scales, [&](const Argument& point) {
                       return motion_calls::propagate(*trial.instance, steps(dt), point, items.record, items.state);
                   });
    if (trial.table.to_cartesian != nullptr)
        compare_points(trial, to_cartesian(*trial.instance, points), trial.cartesian, trial.cartesian_scales,
                       [&](const Argument& point) { return to_cartesian(*trial.instance, point); });
    const Eigen::MatrixXd without = trial.propagate(dt, items);
    const Eigen::MatrixXd with = answered(
        *trial.instance, motion_calls::propagate(*trial.instance, steps(dt), items.state, items.record, items.state));
    for (Eigen::Index i = 0; i < batch; ++i)
        require_same("propagate: without a mean and with the state as the mean", without.col(i), with.col(i),
                     trial.scales, trial.state);
}

PELORUS_CHECK(
    motion, "motion-answers-at-rest", 3,
    "States in which components are 0 (at rest, not turning, at the origin) are answered like any other, "
    "near the answers nearby; tracks begin so, and closed forms that divide by a component fail there. Where a "
    "distance (in m or 1/m, such as the range of polar coordinates) is 0 an item may be refused instead.",
    {"motion-zero-step-is-identity"}) {
    MotionTrial trial(bench);
    std::vector<std::string> titles;  // each component 0 by itself, then all
    Eigen::MatrixXd at(trial.n, trial.n + 1);
    for (Eigen::Index i = 0; i < at.cols(); ++i) {
        at.col(i) = trial.sample.state(*trial.info.state);
        if (i < trial.n) at(i, i) = 0;
        titles.push_back(i < trial.n ? trial.state[static_cast<int>(i)].name + " = 0" : "all components 0");
    }
    at.col(trial.n).setZero();
    drop_refused(trial, at, titles);
    if (titles.empty()) skip("it refuses each state in which a component is 0, as it may");
    const MotionItems items = trial.items_at(at);
    const Eigen::VectorXd dt = Eigen::VectorXd::Constant(at.cols(), trial.sample.step());
    for (const HotCall& call : calls_at(trial, dt, items)) {
        const Execution done = execute(*trial.instance, call);
        for (std::int64_t i = 0; i < at.cols(); ++i) {
            const std::string& title = titles[static_cast<std::size_t>(i)];
            if (done.failed(i) || done.status < 0)
                FAIL(call.function << " refuses a state with " << title << ": " << done.told());
            for (const double value : HotCall::item_of(call.out[0], done.out[0], i))
                if (!std::isfinite(value)) FAIL(call.function << " answers " << value << " for a state with " << title);
        }
    }
    // Nearby: a thousandth of a component's scale moves the answer by a few of them, taken by the Jacobian there.
    const Eigen::MatrixXd here = trial.propagate(dt, items);
    Eigen::MatrixXd beside = at;
    for (Eigen::Index i = 0; i < at.cols(); ++i)
        for (Eigen::Index r = 0; r < trial.n; ++r)
            if (at(r, i) == 0) beside(r, i) += 1e-6 * trial.scales(r);
    const Eigen::MatrixXd there = trial.propagate(dt, beside, items);
    const auto slopes = trial.jacobian(dt, beside, items);
    for (Eigen::Index i = 0; i < at.cols(); ++i) {
        const Eigen::VectorXd step = (beside.col(i) - at.col(i)).cwiseAbs();
        const Eigen::VectorXd allowed = 3 * slopes[static_cast<std::size_t>(i)].cwiseAbs() * step +
                                        1e-5 * trial.scales + 1e-9 * here.col(i).cwiseAbs();
        const std::string jump = first_difference(here.col(i), there.col(i), allowed, trial.state);
        if (!jump.empty())
            FAIL("propagate of a state with " << titles[static_cast<std::size_t>(i)] << ": " << jump
                                              << " (a millionth of a scale beside it)");
    }
}

PELORUS_CHECK(motion, "motion-record-advances-in-place", 3,
              "advance_record answers the same where `out` is the record itself; estimators advance records in place.",
              {"numbers-finite"}) {
    MotionTrial trial(bench);
    if (trial.info.record_size == 0) skip("keeps no record");
    const MotionItems items = trial.draw(batch);
    const Eigen::VectorXd dt = trial.drawn_steps(batch);
    const MotionItems later = trial.draw(batch);  // a posterior other than the one that the record remembers
    const HotCall apart =
        motion_calls::advance_record(*trial.instance, steps(dt), later.state, later.covariance, items.record);
    HotCall in_place = apart;
    in_place.in.pop_back();
    in_place.invoke = [&](const plr_call& context, const Views& v) {
        plr_view record = v.out[0];
        for (std::int64_t i = 0; i < record.count; ++i)
            for (std::int64_t r = 0; r < record.rows; ++r)
                record.data[i * record.item_stride + r * record.row_stride] = item(items.record, i)(r, 0);
        const plr_const_view before{record.data,       record.rows,       record.cols,       record.count,
                                    record.row_stride, record.col_stride, record.item_stride};
        const plr_motion_record args{sizeof args, 0, v.in[0], v.in[1], v.in[2], before, record};
        return trial.table.advance_record(trial.instance->self(), &context, &args);
    };
    const Execution one = execute_well(*trial.instance, apart), other = execute_well(*trial.instance, in_place);
    for (std::int64_t i = 0; i < batch; ++i) {
        std::string difference;
        if (!same_item(apart, one, i, in_place, other, i, difference))
            FAIL("advance_record: apart and in place, " << difference);
    }
}

PELORUS_CHECK(motion, "motion-record-refuses-unknown-versions", 3,
              "A record of a version that nobody has written is refused by PLR_E_STATE_VERSION; read as today's it "
              "would make noise of chance.",
              {"numbers-finite"}) {
    const MotionTrial trial(bench);
    const auto* convert = trial.instance->extension<plr_record_convert>(PLR_RECORD_CONVERT);
    if (convert == nullptr) skip(std::string("does not offer ") + PLR_RECORD_CONVERT);
    const std::int64_t size = trial.info.record_size;
    for (const std::uint32_t version : {trial.info.record_version + 1, trial.info.record_version + 0x51ED2705u}) {
        HotCall call = make_call("record.convert", 1);
        call.in = {input("in", size, 1, 1, [&](double* out, std::int64_t) { std::fill_n(out, size, 0.5); })};
        call.out = {output("out", size, 1, Content::opaque)};
        call.invoke = [&](const plr_call& context, const Views& v) {
            return convert->convert(trial.instance->self(), &context, version, &v.in[0], &v.out[0]);
        };
        const Execution done = execute(*trial.instance, call);
        if (done.status != PLR_E_STATE_VERSION)
            FAIL("record.convert from version " << version << " (today's is " << trial.info.record_version
                                                << ") answered " << done.told() << ", expected PLR_E_STATE_VERSION");
    }
}

PELORUS_CHECK(motion, "motion-conversions-are-inverse", 3,
              "to_cartesian and from_cartesian lead to each other's beginning; tracks are published in the one and "
              "filtered in the other.",
              {"numbers-finite"}) {
    MotionTrial trial(bench);
    if (trial.table.to_cartesian == nullptr || trial.table.from_cartesian == nullptr) skip("its state is Cartesian");
    const MotionItems items = trial.draw(batch);
    const auto to = [&](const Eigen::MatrixXd& x) {
        return answered(*trial.instance, motion_calls::to_cartesian(*trial.instance, columns("in", x)));
    };
    const auto from = [&](const Eigen::MatrixXd& c) {
        return answered(*trial.instance, motion_calls::from_cartesian(*trial.instance, columns("in", c)));
    };
    // One point may have several states (a negative speed turned about): the state that comes back stands for all.
    const Eigen::MatrixXd point = to(states_of(items)), state = from(point), again = to(state), back = from(again);
    for (Eigen::Index i = 0; i < batch; ++i) {
        INFO("state " << text_of(states_of(items).col(i)));
        const std::string lost = first_difference(
            again.col(i), point.col(i), Eigen::VectorXd(1e-9 * (point.col(i).cwiseAbs() + trial.cartesian_scales)),
            trial.cartesian);
        if (!lost.empty()) FAIL("to_cartesian(from_cartesian(.)): " << lost);
        const std::string other = first_difference(
            back.col(i), state.col(i), Eigen::VectorXd(1e-9 * (state.col(i).cwiseAbs() + trial.scales)), trial.state);
        if (!other.empty()) FAIL("from_cartesian(to_cartesian(.)): " << other);
    }
}

PELORUS_CHECK(motion, "motion-conversion-jacobians-are-derivatives", 3,
              "The Jacobians of to_cartesian and from_cartesian are their derivatives; covariances are published "
              "through them.",
              {"numbers-finite"}) {
    MotionTrial trial(bench);
    if (trial.table.to_cartesian == nullptr || trial.table.from_cartesian == nullptr) skip("its state is Cartesian");
    const auto compare = [&](const char* function, const Eigen::VectorXd& at, const Space& by,
                             const Eigen::VectorXd& scales, const Space& of, const Eigen::VectorXd& scales_of_output,
                             HotCall (*call)(const Instance&, const Argument&)) {
        const Eigen::MatrixXd said = answered_matrices(*trial.instance, call(*trial.instance, columns("in", at)), 1)[0];
        const Differences differences(at, scales);
        const Eigen::MatrixXd values =
            answered(*trial.instance, call(*trial.instance, columns("in", differences.points())));
        const std::string wrong =
            disagreement(said, differences.estimate(values, of), of, by, scales_of_output, scales);
        if (!wrong.empty()) FAIL(function << ": jacobian: " << wrong << " at " << text_of(at));
    };
    for (int i = 0; i < batch; ++i) {
        const Eigen::VectorXd x = trial.sample.state(*trial.info.state);
        compare("to_cartesian", x, trial.state, trial.scales, trial.cartesian, trial.cartesian_scales,
                &motion_calls::to_cartesian);
        const Eigen::VectorXd c =
            answered(*trial.instance, motion_calls::to_cartesian(*trial.instance, columns("in", x))).col(0);
        compare("from_cartesian", c, trial.cartesian, trial.cartesian_scales, trial.state, trial.scales,
                &motion_calls::from_cartesian);
    }
}

}  // namespace pelorus::conformance
