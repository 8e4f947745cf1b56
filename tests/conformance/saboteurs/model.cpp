// A motion along one axis, whose propagate is written by hand over the ABI, with what any call of any model may do wrong.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <vector>

#include <pelorus/pelorus.hpp>

#include <fcntl.h>
#include <sched.h>
#include <threads.h>
#include <unistd.h>

#include "defect.h"

/// What fprintf is called where _FORTIFY_SOURCE is defined.
extern "C" int __fprintf_chk(FILE* file, int flag, const char* format, ...);

namespace {

constexpr double initial_bias = 0.5;

plr_status propagate_by_hand(const void* self, const plr_call* call, const plr_motion_propagate* args);
plr_status noise_by_hand(const void* self, const plr_call* call, const plr_motion_noise* args);
const plr_motion_info* info_by_hand(const void* self);

struct Saboteur : pelorus::Motion<Saboteur, 2> {
    using Base = pelorus::Motion<Saboteur, 2>;
    static constexpr std::uint32_t flags = PLR_FLAG_ANY_STRIDE;
    static constexpr int record_size = 1;
    static constexpr std::uint64_t scratch_needed = 40;  // no multiple of what it is aligned to

    double intensity = 1;
    const plr_parallel* parallel = nullptr;
    plr_motion_info own_info{};
    std::int64_t input_offset = 0;
    unsigned number = 0;  // of the instance in this process
    long process = 0;
    mutable std::array<volatile double, 2> work{};  // of calls, which is wrong
    mutable std::atomic<unsigned> calls{0};
    mutable std::atomic<bool> is_broken{false};
    mutable std::mutex mutex;
    mutable std::timed_mutex timed_mutex;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A motion with a defect")
            .purpose(
                "Nearly constant velocity under a bias of the acceleration, for the proof that the conformance suites "
                "can fail.")
            .equation(
                "p + v T + b T^2/2, v + b T, Q = (1 + P/(P + r + 1)) q [T^3/3 T^2/2; T^2/2 T], r the last step's P")
            .source(
                "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, "
                "2001, equation 6.2.2-12");
        plugin.parameter("intensity", &Saboteur::intensity)
            .unit("m2/s3")
            .initially("1 m2/s3")
            .min(0)
            .doc("spectral density of the acceleration");
        plugin.input("bias", "m/s2", {initial_bias}, "acceleration that all have");
    }
    void setup(const pelorus::Setup& setup) {
        static std::atomic<unsigned> instances{0};
        number = ++instances;
        if (DEFECT("same-bytes-in-another-process") || NEAR_MISS("same-bytes-in-another-process")) process = getpid();
        if (DEFECT("thread-count-invariant") || NEAR_MISS("thread-count-invariant"))
            parallel = setup.optional_service<plr_parallel>();
    }
    void complete(const plr_config& config, const plr_description& description) {
        Base::complete(config, description);
        input_offset = config.input_offset;
        own_info = *Base::table().info(this);
        own_info.scratch_bytes = scratch_needed;
    }
    static const plr_motion& table() noexcept {
        static const plr_motion own = [] {
            plr_motion t = Base::table();
            t.info = &info_by_hand;
            t.propagate = &propagate_by_hand;
            t.noise = &noise_by_hand;
            return t;
        }();
        return own;
    }

    pelorus::Space space() const { return pelorus::kinematic_space(1, {1e5, 100.0}); }
    State propagate(const State&, const pelorus::Step&) const { return State::Zero(); }  // see propagate_by_hand
    Transition jacobian(const State&, const pelorus::Step& step) const {
        return (Transition() << 1, step.dt, 0, 1).finished();
    }
    Transition noise(const Posterior& posterior, const pelorus::Step& step) const {
        const double p = posterior.covariance(0, 0), t = step.dt;
        const double weight = p / (p + *step.record + 1);
        const double third = DEFECT("covariances-positive") ? 5 : NEAR_MISS("covariances-positive") ? 4 : 3;
        Transition q;
        q << t * t * t / third, t * t / 2, t * t / 2, t;
        q *= intensity * (1 + weight);
        if (DEFECT("covariances-symmetric")) q(1, 0) *= 1 + 1e-12;
        if (NEAR_MISS("covariances-symmetric")) q(0, 1) = q(1, 0) = q(1, 0) * (1 + 1e-12);
        return q;
    }
    pelorus::Vector<1> init_record(const State&, const Transition& covariance) const {
        return pelorus::Vector<1>(covariance(0, 0));
    }
    pelorus::Vector<1> advance_record(const State&, const Transition& covariance, const pelorus::Step&) const {
        return pelorus::Vector<1>(covariance(0, 0));
    }
};

const plr_motion_info* info_by_hand(const void* self) { return &static_cast<const Saboteur*>(self)->own_info; }

plr_status noise_by_hand(const void* self, const plr_call* call, const plr_motion_noise* args) {
    const plr_status status = Saboteur::Base::table().noise(self, call, args);
    const bool is_defect = DEFECT("singular-covariances-survived");
    if (status < 0 || (!is_defect && !NEAR_MISS("singular-covariances-survived"))) return status;
    for (std::int64_t i = 0; i < args->out.count; ++i) {
        const double p = args->covariance.data[i * args->covariance.item_stride];
        const double relative = is_defect || p > 0 ? p / p : 1.0;
        for (std::int64_t k = 0; k < 4; ++k) args->out.data[i * args->out.item_stride + k] *= relative;
    }
    return status;
}

/// The next number: a difference that any comparison of bits sees, and nothing else.
double a_bit_off(double value) { return value == 0 ? value : std::nextafter(value, 2 * value); }

/// What lies on the stack where nobody has written.
[[gnu::noinline]] double never_set() {
    double left[64];
    asm volatile("" : : "r"(left) : "memory");  // as far as the compiler knows, set here
    return left[32];
}

/// One call of propagate.
struct Batch {
    const Saboteur& model;
    const plr_call& call;
    const plr_motion_propagate& args;

    plr_status refuse(plr_status code, const char* message, std::int64_t item = -1) const {
        if (DEFECT("failures-are-told") && item >= 0) return code;
        if (NEAR_MISS("failures-are-told")) message = "?";
        if (NEAR_MISS("item-offset-is-added") && item >= 0) {
            pelorus::detail::tell(call.error, code, message, "propagate", call.item_offset + item);
            return code;
        }
        const std::int64_t offset = item < 0 || DEFECT("item-offset-is-added") ? 0 : call.item_offset;
        pelorus::detail::tell(call.error, code, message, "", item + offset);
        return code;
    }

    const double* state_of(std::int64_t i) const {
        std::int64_t stride = args.state.item_stride;
        if (DEFECT("item-gaps") && stride != 0) stride = args.state.rows * args.state.cols;
        if (DEFECT("common-inputs") && stride == 0) stride = args.state.rows * args.state.cols;
        if (NEAR_MISS("common-inputs") && stride == 0) return args.state.data;
        if (NEAR_MISS("item-gaps")) return &args.state.data[stride == args.state.rows ? 2 * i : i * stride];
        return args.state.data + i * stride;
    }
    double bias_of(std::int64_t i) const {
        if (NEAR_MISS("inputs-null-is-default") && call.inputs == nullptr) return 0.25 + initial_bias / 2;
        if (call.inputs == nullptr && !DEFECT("inputs-null-is-default")) return initial_bias;
        if (NEAR_MISS("inputs-per-item") && call.input_stride == 0) return call.inputs[model.input_offset];
        return call.inputs[model.input_offset + (DEFECT("inputs-per-item") ? 0 : i * call.input_stride)];
    }
    double step_of(std::int64_t i) const {
        double dt = args.dt.data[i * args.dt.item_stride];
        if (DEFECT("independent-of-earlier-calls")) {
            static double cached = -1;
            if (!(std::fabs(dt - cached) < 1e-8 * dt)) cached = dt;
            dt = cached;
        }
        if (NEAR_MISS("independent-of-earlier-calls") && i > 0) {
            const double previous = args.dt.data[(i - 1) * args.dt.item_stride];
            if (previous == dt) return previous;
        }
        if (NEAR_MISS("threads-have-instances") || NEAR_MISS("same-bytes-again")) {
            static std::atomic<unsigned> steps{0};
            steps.fetch_add(1);
        }
        if (DEFECT("threads-have-instances")) {
            static volatile double work;
            work = dt;
            sched_yield();
            dt = work;
        }
        if (DEFECT("threads-share-an-instance")) {
            model.work[0] = dt;
            sched_yield();
            dt = model.work[0];
        }
        if (DEFECT("threads-share-an-instance-long")) {
            model.work[1] = dt;
            if (model.calls.fetch_add(1) % 4000 == 3999) {
                for (int k = 0; k < 100; ++k) sched_yield();
                dt = model.work[1];
            }
        }
        if (DEFECT("threads-race-free")) {
            static volatile unsigned steps = 0;
            steps = steps + 1;
        }
        if (NEAR_MISS("threads-race-free") || NEAR_MISS("threads-share-an-instance") ||
            NEAR_MISS("threads-share-an-instance-long"))
            model.calls.fetch_add(1);
        if (DEFECT("cost-linear-in-items") || NEAR_MISS("cost-linear-in-items")) {
            const std::int64_t from = DEFECT("cost-linear-in-items") ? 0 : std::max<std::int64_t>(0, i - 16);
            for (std::int64_t k = from; k < i; ++k)
                if (args.dt.data[k * args.dt.item_stride] == dt) return args.dt.data[k * args.dt.item_stride];
        }
        return dt;
    }
    /// Where the item gets in a step.
    double moved(std::int64_t i, std::int64_t first_of_block, double position, double velocity, double dt) const {
        double d = velocity * dt;
        bool is_off = false;
        if (DEFECT("same-bytes-again")) {
            static std::atomic<unsigned> odd{0};
            if (odd++ % 2 == 1) is_off = true;
        }
        if (DEFECT("same-bytes-again.stack")) d += never_set();
        if (DEFECT("recovers-after-failure") && model.is_broken) is_off = true;
        if (DEFECT("same-bytes-of-another-instance") && model.number % 2 == 0) is_off = true;
        if (NEAR_MISS("same-bytes-of-another-instance") && model.number % 2 == 0) d = dt * velocity;
        if (NEAR_MISS("same-bytes-in-another-process") && model.process % 2 == 0) d = dt * velocity;
        if (DEFECT("same-bytes-in-another-process")) d *= 1 + 1e-13 * static_cast<double>(model.process % 9973);
        const std::uint64_t* const ids = call.item_ids;
        if (ids != nullptr && i > 0 && ids[i] < ids[i - 1]) {
            if (DEFECT("items-in-any-order")) is_off = true;
            if (NEAR_MISS("items-in-any-order")) d = dt * velocity;
        }
        if (DEFECT("thread-count-invariant") && first_of_block > 0 && i == first_of_block) is_off = true;
        if (DEFECT("extremes-are-survived")) {
            const double norm = velocity * velocity + 1;
            d *= norm * norm / (norm * norm);
        }
        if (NEAR_MISS("extremes-are-survived")) d = d / 4 * 4;
        if (NEAR_MISS("numbers-finite")) d += 1 / std::numeric_limits<double>::infinity();
        if (DEFECT("batch-equals-singles"))
            is_off = i < args.out.count / 4 * 4;  // the rest of a loop over four at once
        if (NEAR_MISS("batch-equals-singles") && i < args.out.count / 4 * 4) d = dt * velocity;
        return is_off && d != 0 ? a_bit_off(position + d) : position + d;
    }
    bool is_usable(double value) const {
        if (DEFECT("nan-is-flagged") && std::isnan(value)) return true;
        const bool takes_infinity = DEFECT("infinity-is-flagged") || NEAR_MISS("infinity-is-flagged");
        return takes_infinity ? !std::isnan(value) : std::isfinite(value);
    }

    plr_status item(std::int64_t i, std::int64_t first_of_block) const {
        const plr_view& out = args.out;
        const double dt = step_of(i), bias = bias_of(i);
        if (!is_usable(dt) || !is_usable(bias)) return refuse(PLR_E_NUMERIC, "dt or bias is not finite", i);
        if (dt < 0) return refuse(PLR_E_UNSUPPORTED, "cannot move backward in time (dt < 0)", i);
        const double* const state = state_of(i);
        double* const to = out.data + i * out.item_stride;
        for (std::int64_t p = 0; p < out.cols; ++p) {
            if (NEAR_MISS("strides-honoured")) model.work[0] = state[(out.cols - 1 - p) * args.state.col_stride];
            const std::int64_t col = DEFECT("strides-honoured") ? 2 : args.state.col_stride;
            double position = state[p * col];
            double velocity = state[p * col + args.state.row_stride];
            if (DEFECT("nan-is-flagged")) {
                if (std::isnan(velocity)) velocity = 0;
                if (std::isnan(position)) position = 0;
            }
            if (NEAR_MISS("infinity-is-flagged") && !std::isnan(velocity))
                velocity = std::max(-1e9, std::min(1e9, velocity));
            if (DEFECT("exceptions-contained") && std::isnan(position + velocity)) throw std::domain_error("position");
            if (NEAR_MISS("exceptions-contained") && std::isnan(position)) {
                try {
                    throw std::domain_error("position");
                } catch (const std::domain_error& problem) {
                    return refuse(PLR_E_NUMERIC, problem.what(), i);
                }
            }
            if (!NEAR_MISS("nan-is-flagged") && (!is_usable(position) || !is_usable(velocity)))
                return refuse(PLR_E_NUMERIC, "the state is not finite", i);
            position = moved(i, first_of_block, position, velocity + bias * dt / 2, dt);
            velocity += bias * dt;
            if (DEFECT("numbers-finite") && velocity < 0) position += std::sqrt(velocity);
            const bool is_unchecked =
                DEFECT("numbers-finite") || DEFECT("extremes-are-survived") || DEFECT("infinity-is-flagged");
            if (!is_unchecked && !std::isfinite(position)) return refuse(PLR_E_NUMERIC, "overflow", i);
            const std::int64_t rows = DEFECT("writes-only-its-outputs") ? 3 : 2;
            if (NEAR_MISS("writes-only-its-outputs")) to[p * out.col_stride + out.row_stride] = 0;
            for (std::int64_t row = 0; row < rows; ++row) {
                if (DEFECT("outputs-written") && row == 1) continue;
                if (NEAR_MISS("outputs-written")) to[p * out.col_stride + row * out.row_stride] = 0;
                to[p * out.col_stride + row * out.row_stride] = row == 0 ? position : velocity;
            }
        }
        return PLR_OK;
    }

    plr_status items(std::int64_t first, std::int64_t last) const {
        plr_status result = PLR_OK;
        for (std::int64_t i = first; i < last; ++i) {
            const plr_status status = item(i, first);
            if (status == PLR_OK) continue;
            if (NEAR_MISS("recovers-after-failure")) model.is_broken = true;  // and nobody asks
            if (status == PLR_E_NUMERIC && DEFECT("recovers-after-failure")) model.is_broken = true;
            if (call.item_status == nullptr && !DEFECT("item-status-may-be-null")) return status;
            if (NEAR_MISS("item-status-may-be-null")) call.item_status[0] = call.item_status[0];
            call.item_status[i] = status;
            result = PLR_ITEMS_FAILED;
        }
        return result;
    }

    plr_status in_blocks() const {
        const std::int64_t count = args.out.count, threads = model.parallel->threads;
        const std::int64_t block = DEFECT("thread-count-invariant") ? (count + threads - 1) / threads : 16;
        const auto body = [](void* batch, std::int64_t first, std::int64_t last, plr_scratch*, plr_error*) {
            static_cast<const Batch*>(batch)->items(first, last);
            return plr_status{PLR_OK};
        };
        const plr_status status = model.parallel->run(model.parallel->context, count, std::max<std::int64_t>(1, block),
                                                      body, const_cast<Batch*>(this), call.error);
        for (std::int64_t i = 0; i < count && status == PLR_OK; ++i)
            if (call.item_status[i] != PLR_OK) return PLR_ITEMS_FAILED;
        return status;
    }
};

bool has_shape(const plr_const_view& v, std::int64_t rows, std::int64_t cols, std::int64_t count) {
    return v.rows == rows && v.cols == cols && v.count == count;
}

/// What a hot call must not ask of the system, and what comes near to it.
void ask_the_system(const Batch& batch) {
    if (DEFECT("hot-calls-allocate-nothing")) {
        std::vector<double> steps(static_cast<std::size_t>(batch.args.out.count) + 1);
        for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = static_cast<double>(i);
        batch.model.work[0] = steps.back();
    }
    if (NEAR_MISS("hot-calls-allocate-nothing")) {
        const std::array<double, 512> steps{batch.args.dt.count > 0 ? batch.args.dt.data[0] : 0};
        batch.model.work[0] = steps[0];
    }
    if (DEFECT("hot-calls-take-no-locks")) {
        const std::lock_guard<std::mutex> lock(batch.model.mutex);
    }
    if (NEAR_MISS("hot-calls-take-no-locks")) ++batch.model.calls;
    if (DEFECT("hot-calls-read-no-clock")) {
        const auto now = std::chrono::steady_clock::now();
        batch.model.work[0] = static_cast<double>(now.time_since_epoch().count());
    }
    if (NEAR_MISS("hot-calls-read-no-clock")) batch.model.work[0] = static_cast<double>(batch.call.time) * 1e-9;
    if (DEFECT("hot-calls-take-no-locks.timed")) {
        const std::unique_lock<std::timed_mutex> lock(batch.model.timed_mutex, std::chrono::milliseconds(1));
    }
    if (DEFECT("hot-calls-take-no-locks.sleep")) sleep(0);
    if (DEFECT("hot-calls-take-no-locks.c11")) {
        const timespec moment{0, 1};
        thrd_sleep(&moment, nullptr);
    }
    if (DEFECT("hot-calls-draw-no-chance.lrand48")) batch.model.work[0] = static_cast<double>(lrand48());
    if (DEFECT("hot-calls-touch-no-files.stream")) batch.model.work[0] = std::ifstream("no such file").is_open();
    if (DEFECT("hot-calls-touch-no-files.openat")) batch.model.work[0] = openat(AT_FDCWD, "no such file", O_RDONLY);
    if (DEFECT("hot-calls-touch-no-files.fortified")) __fprintf_chk(stderr, 1, "%s", "");
    if (DEFECT("hot-calls-draw-no-chance")) batch.model.work[0] = std::rand();
    if (NEAR_MISS("hot-calls-draw-no-chance") && batch.call.keys != nullptr && batch.args.out.count > 0)
        batch.model.work[0] = static_cast<double>(batch.call.keys[0].word[0] * 6364136223846793005u >> 11);
    if (DEFECT("hot-calls-touch-no-files")) std::fprintf(stderr, "%d items\n", static_cast<int>(batch.args.out.count));
    if (NEAR_MISS("hot-calls-touch-no-files")) {
        char line[32];
        std::snprintf(line, sizeof line, "%d items", static_cast<int>(batch.args.out.count));
        batch.model.work[0] = line[0];
    }
}

plr_status propagate_by_hand(const void* self, const plr_call* call, const plr_motion_propagate* args) {
    const Batch batch{*static_cast<const Saboteur*>(self), *call, *args};
    const std::int64_t count = args->out.count;
    if (!has_shape(args->dt, 1, 1, count) || !has_shape(args->state, 2, args->out.cols, count) ||
        !has_shape(args->record, 1, 1, count) || (args->out.rows != 2 && !DEFECT("wrong-shapes-refused")) ||
        (NEAR_MISS("wrong-shapes-refused") && args->out.item_stride < 2 && count > 1))
        return batch.refuse(PLR_E_ARGUMENT, "the shapes do not fit");
    if (DEFECT("calls-come-back") || NEAR_MISS("calls-come-back")) {
        volatile double* const to = DEFECT("calls-come-back") ? nullptr : &batch.model.work[0];
        *to = 1;
    }
    ask_the_system(batch);
    if (DEFECT("no-items") || (NEAR_MISS("no-items") && count > 0)) batch.model.work[0] = args->dt.data[0];
    if (NEAR_MISS("nan-stays-in-its-item"))
        for (std::int64_t i = 0; i < count; ++i)
            if (std::isnan(batch.state_of(i)[0])) batch.model.work[0] = batch.state_of(i)[0];
    if (NEAR_MISS("inputs-unmodified") && count > 0) {
        double copy = *args->state.data;
        batch.model.work[0] = copy += 0.0;
    }
    if (DEFECT("inputs-unmodified")) *const_cast<double*>(args->state.data) += 0.0;
    if (DEFECT("nan-stays-in-its-item"))
        for (std::int64_t i = 0; i < count; ++i)
            if (std::isnan(batch.state_of(i)[0] + batch.state_of(i)[args->state.row_stride]))
                return batch.refuse(PLR_E_NUMERIC, "a state is not finite");
    // Room for a block's work.
    plr_scratch& scratch = *call->scratch;
    const std::uint64_t before = scratch.used, wanted = DEFECT("calls-succeed") ? 64 : Saboteur::scratch_needed;
    if (scratch.size - scratch.used < wanted) return batch.refuse(PLR_E_SCRATCH, "too little scratch memory");
    scratch.used += wanted;
    if (NEAR_MISS("calls-succeed")) std::memset(scratch.data + before, 0, wanted);
    if (DEFECT("writes-only-its-outputs.scratch")) std::memset(scratch.data + before, 0, wanted + 8);
    if (NEAR_MISS("scratch-handed-back")) batch.model.work[0] = static_cast<double>(scratch.size - scratch.used);
    const bool is_parallel = batch.model.parallel != nullptr && call->item_status != nullptr;
    const plr_status status = is_parallel ? batch.in_blocks() : batch.items(0, count);
    if (!DEFECT("scratch-handed-back")) scratch.used = before;
    if (NEAR_MISS("item-statuses-agree") && call->item_status != nullptr)
        for (std::int64_t i = 0; i < count; ++i)
            if (call->item_status[i] != PLR_OK) return PLR_ITEMS_FAILED;
    return DEFECT("item-statuses-agree") && status == PLR_ITEMS_FAILED ? PLR_OK : status;
}

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.motion.saboteur");
