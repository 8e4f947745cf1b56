// What the filter is made from, and the calls around its step: start, moments, assignment.
#include "imm.hpp"

#include <cstring>

#include <pelorus/abi/record.h>

namespace imm {

using pelorus::PartError;
using pelorus::Scratch;

namespace {

bool share_a_component(const pelorus::Space& a, const pelorus::Space& b) {
    return std::any_of(a.components().begin(), a.components().end(),
                       [&](const pelorus::Component& component) { return b.index(component.name) >= 0; });
}

/// A model that shares no component with any other would lose all that it knows at every mixing.
void refuse_strangers(const std::vector<pelorus::Space>& states, const std::vector<const char*>& names) {
    for (std::size_t j = 0; j < states.size() && states.size() > 1; ++j) {
        std::size_t sharing = 0;  // itself among them
        for (const pelorus::Space& state : states) sharing += share_a_component(states[j], state) ? 1u : 0u;
        if (sharing == 1)
            throw PartError("estimators", std::string(names[j]) + " has no component of its state (" +
                                              states[j].text() +
                                              ") in common with another filter, so that there is nothing to mix");
    }
}

/// So would all of them at each change from one half to the other, where no component of the one is in the other.
void refuse_halves(const std::vector<pelorus::Space>& states, const std::vector<const char*>& names) {
    std::vector<std::size_t> reached{0};  // from the first, through those that share something
    std::vector<bool> is_reached(states.size(), false);
    is_reached[0] = true;
    for (std::size_t k = 0; k < reached.size(); ++k) {
        const std::size_t from = reached[k];
        for (std::size_t j = 0; j < states.size(); ++j) {
            if (is_reached[j] || !share_a_component(states[from], states[j])) continue;
            is_reached[j] = true;
            reached.push_back(j);
        }
    }
    if (reached.size() == states.size()) return;
    const auto half = [&](bool first) {
        std::string text;
        for (std::size_t j = 0; j < states.size(); ++j)
            if (is_reached[j] == first) text += (text.empty() ? "" : ", ") + std::string(names[j]);
        return text;
    };
    throw PartError("estimators",
                    "are of two halves that have no component in common, so that nothing can be mixed "
                    "between them: " +
                        half(true) + " and " + half(false));
}

}  // namespace

void Filter::build(const pelorus::Setup& setup) {
    const auto parts = setup.parts<pelorus::EstimatorPart>("estimators");
    if (parts.empty()) throw PartError("estimators", "slot estimators is empty, one filter at least is needed");
    if (parts.size() > max_models)
        throw PartError("estimators", "holds " + std::to_string(parts.size()) + " filters, at most " +
                                          std::to_string(max_models) + " are taken");
    if (parts.size() > 1 && !(stay_ * static_cast<double>(parts.size()) >= 1))
        throw pelorus::ParameterError(
            "stay", "must be at least 1/" + std::to_string(parts.size()) + ", which is leaving a model to chance");
    std::vector<pelorus::Space> states, cartesians;
    record_size_ = static_cast<std::int64_t>(parts.size());
    for (const auto& part : parts) {
        if ((part.info().flags & PLR_ESTIMATOR_ASSIGNABLE) == 0)
            throw PartError("estimators", part.name() + " (" + part.id() +
                                              ") does not take moments (PLR_ESTIMATOR_ASSIGNABLE), through which "
                                              "filters are mixed");
        states.emplace_back(*part.info().state);
        cartesians.emplace_back(*part.info().cartesian);
        models_.push_back(
            {part, states.back().size(), cartesians.back().size(), part.info().record_size, record_size_, {}});
        record_size_ += part.info().record_size;
        names_.push_back(part.raw().name[0] == 0 ? part.raw().description->id : part.raw().name);
    }
    refuse_strangers(states, names_);
    refuse_halves(states, names_);
    state_ = JoinedSpace(states);
    cartesian_ = JoinedSpace(cartesians);
    add_sensors(parts);
}

/// All filters look through the same sensors; ours are those of the first.
void Filter::add_sensors(const std::vector<pelorus::EstimatorPart>& parts) {
    const auto sensors_of = [](const plr_estimator_info& info) {
        std::vector<pelorus::SensorPart> out;
        const char* at = reinterpret_cast<const char*>(info.sensors);
        for (std::uint32_t s = 0; s < info.sensor_count; ++s) {
            out.emplace_back(*reinterpret_cast<const plr_part*>(at));
            at += info.sensors->struct_size;
        }
        return out;
    };
    for (const pelorus::SensorPart& part : sensors_of(parts.front().info())) {
        const pelorus::Space measured(*part.info().measurement);
        if (measured.size() > max_measurement)
            throw PartError("estimators", "sensor " + part.name() + " measures " + std::to_string(measured.size()) +
                                              " components, at most " + std::to_string(max_measurement) +
                                              " fit this filter");
        SeenBy sensor{measured.size(), {}, part};
        for (int k = 0; k < measured.size(); ++k)
            if (measured[k].angle) sensor.angles.push_back(k);
        for (std::size_t j = 0; j < parts.size(); ++j) {
            const auto others = sensors_of(parts[j].info());
            const auto same = std::find_if(others.begin(), others.end(), [&](const pelorus::SensorPart& other) {
                return other.name() == part.name() && pelorus::Space(*other.info().measurement).same(measured);
            });
            if (same == others.end() || others.size() != parts.front().info().sensor_count)
                throw PartError("estimators", parts[j].name() + " has other sensors than " + parts.front().name() +
                                                  "; all filters take the same (" + part.name() + " measures " +
                                                  measured.text() + ")");
            models_[j].sensors.push_back(static_cast<std::int32_t>(same - others.begin()));
        }
        sensors_.push_back(std::move(sensor));
    }
    if (sensors_.empty()) throw PartError("estimators", parts.front().name() + " has no sensors");
}

plr_estimator_info Filter::told() const {
    plr_estimator_info info{};
    info.struct_size = sizeof info;
    info.flags = PLR_ESTIMATOR_BACKWARD | (is_assignable() ? std::uint32_t{PLR_ESTIMATOR_ASSIGNABLE} : 0u);
    info.record_version = 1;
    for (const Model& model : models_) {
        const plr_estimator_info& own = model.part.info();
        if ((own.flags & PLR_ESTIMATOR_BACKWARD) == 0) info.flags &= ~std::uint32_t{PLR_ESTIMATOR_BACKWARD};
        info.flags |= own.flags & PLR_ESTIMATOR_USES_EXTENT;
        info.record_version = plr_mix_version(info.record_version, own.record_version);
    }
    info.state = state_.space.c();
    info.cartesian = cartesian_.space.c();
    info.record_size = record_size_;
    info.sensor_count = static_cast<std::uint32_t>(sensors_.size());
    info.sensors = models_.front().part.info().sensors;
    info.scratch_bytes = scratch_needed();
    return info;
}

/// The largest need of any call of ours, and of a filter called meanwhile.
std::uint64_t Filter::scratch_needed() const {
    constexpr std::int64_t start = max_state + max_state * max_state;
    std::int64_t moments = 0, crosses = 0, seen = 0;
    std::uint64_t parts = 0;
    for (const Model& model : models_) {
        const std::int64_t k = std::max(model.n, model.c);
        moments += k + k * k;
        crosses += max_state * max_measurement;
        parts = std::max(parts, model.part.info().scratch_bytes);
    }
    for (const SeenBy& sensor : sensors_) {
        seen = std::max(seen, sensor.m + sensor.m * sensor.m);
        parts = std::max(parts, sensor.part.info().scratch_bytes);
    }
    const std::int64_t look = count() * (seen + 1) + 2 * max_measurement;
    const std::int64_t doubles = std::max(start, moments + crosses + look);
    return static_cast<std::uint64_t>(block_size * doubles) * sizeof(double) + parts + 4 * 64;
}

const Filter::SeenBy& Filter::sensor(std::int32_t index) const {
    if (index < 0 || static_cast<std::size_t>(index) >= sensors_.size())
        throw pelorus::ArgumentError("sensor: is " + std::to_string(index) + ", expected 0 to " +
                                     std::to_string(sensors_.size() - 1));
    return sensors_[static_cast<std::size_t>(index)];
}

/// Each filter starts with what it has of the components that are given; all models are equally likely.
plr_status Filter::init(const plr_call& call, const plr_estimator_init& args) const {
    const std::int64_t known = args.known, total = args.record.count;
    for (std::int64_t k = 0; k < known; ++k)
        if (args.components[k] < (k == 0 ? 0 : args.components[k - 1] + 1) || args.components[k] >= cartesian_.size())
            throw pelorus::ArgumentError("components: are not ascending indices below " +
                                         std::to_string(cartesian_.size()));
    expect_packed(args.mean, known, 1, total, "mean");
    expect_packed(args.covariance, known, known, total, "covariance");
    expect_packed(args.record, record_size_, 1, total, "record");
    const Scratch scratch(call, block_size * (max_state + max_state * max_state));
    return in_blocks(call, total, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_view records = pelorus::slice(args.record, first, items);
        for (std::size_t j = 0; j < models_.size(); ++j) {
            std::int32_t components[max_state];
            std::int64_t from[max_state], k = 0;
            const Place& place = cartesian_.places[j];
            for (std::int32_t own = 0; own < models_[j].c; ++own)
                for (std::int64_t g = 0; g < known; ++g)
                    if (args.components[g] == place.at(own)) {
                        components[k] = own;
                        from[k++] = g;
                    }
            double* const covariances = scratch.data() + block_size * max_state;
            for (std::int64_t i = 0; i < items; ++i)
                for (std::int64_t a = 0; a < k; ++a) {
                    scratch.data()[i * k + a] = at(args.mean, first + i)[from[a]];
                    for (std::int64_t b = 0; b < k; ++b)
                        covariances[(i * k + a) * k + b] = at(args.covariance, first + i)[from[a] * known + from[b]];
                }
            auto start = pelorus::arguments<plr_estimator_init>();
            start.known = static_cast<std::uint32_t>(k);
            start.components = components;
            start.mean = pelorus::const_view(scratch.data(), k, 1, items);
            start.covariance = pelorus::const_view(covariances, k, k, items);
            start.record = records_of(models_[j], records);
            tolerate(models_[j].part.call(&plr_estimator::init, block, start));
        }
        return for_good_items(block, items,
                              [&](std::int64_t i) { std::fill_n(at(records, i), count(), 1.0 / count()); });
    });
}

plr_status Filter::summary(const plr_call& call, const plr_estimator_moments& args) const {
    return tell_moments(call, cartesian_, true, args);
}
plr_status Filter::moments(const plr_call& call, const plr_estimator_moments& args) const {
    return tell_moments(call, state_, false, args);
}

plr_status Filter::tell_moments(const plr_call& call, const JoinedSpace& joined, bool is_cartesian,
                                const plr_estimator_moments& args) const {
    const std::int64_t total = args.mean.count, n = joined.size();
    const bool is_wanted = args.covariance.data != nullptr;
    expect_packed(args.record, record_size_, 1, total, "record");
    expect_packed(args.mean, n, 1, total, "mean");
    if (is_wanted) expect_packed(args.covariance, n, n, total, "covariance");
    const Scratch scratch(call, moment_doubles(is_cartesian));
    return in_blocks(call, total, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_const_view records = pelorus::slice(args.record, first, items);
        ask_moments(block, records, is_cartesian, scratch.data());
        return for_good_items(block, items, [&](std::int64_t i) {
            Gaussian<max_state> models[max_models];
            load(joined, is_cartesian, scratch.data(), i, models);
            const Gaussian<max_state> mixed = mixture(models, weights_of(records, i), count(), joined.angles);
            if (!pelorus::small::all_finite(mixed.mean) || !pelorus::small::all_finite(mixed.covariance))
                throw pelorus::NumericError("the mixture of the models is not finite");
            std::copy_n(mixed.mean.data(), n, at(args.mean, first + i));
            if (is_wanted) std::copy_n(mixed.covariance.data(), n * n, at(args.covariance, first + i));
        });
    });
}

std::int64_t Filter::moment_doubles(bool is_cartesian) const {
    std::int64_t doubles = 0;
    for (const Model& model : models_) {
        const std::int64_t k = is_cartesian ? model.c : model.n;
        doubles += k + k * k;
    }
    return block_size * doubles;
}

/// `memory` gets, for one model after the other, block_size means and block_size covariances.
void Filter::ask_moments(const plr_call& block, const plr_const_view& records, bool is_cartesian,
                         double* memory) const {
    for (const Model& model : models_) {
        const std::int64_t k = is_cartesian ? model.c : model.n;
        auto ask = pelorus::arguments<plr_estimator_moments>();
        ask.record = records_of(model, records);
        ask.mean = pelorus::view(memory, k, 1, records.count);
        ask.covariance = pelorus::view(memory + block_size * k, k, k, records.count);
        tolerate(model.part.call(is_cartesian ? &plr_estimator::summary : &plr_estimator::moments, block, ask));
        memory += block_size * (k + k * k);
    }
}

void Filter::load(const JoinedSpace& joined, bool is_cartesian, const double* memory, std::int64_t item,
                  Gaussian<max_state>* out) const {
    for (std::size_t j = 0; j < models_.size(); ++j) {
        const std::int64_t k = is_cartesian ? models_[j].c : models_[j].n;
        out[j] = joined.places[j].widened(memory + item * k, memory + block_size * k + item * k * k, joined.prior);
        memory += block_size * (k + k * k);
    }
}

/// All models get these moments; how likely they are stays.
plr_status Filter::assign(const plr_call& call, const plr_estimator_assign& args) const {
    const std::int64_t total = args.out.count, n = state_.size();
    expect_packed(args.record, record_size_, 1, total, "record");
    expect_packed(args.mean, n, 1, total, "mean");
    expect_packed(args.covariance, n, n, total, "covariance");
    expect_packed(args.out, record_size_, 1, total, "out");
    return in_blocks(call, total, [&](const plr_call& block, std::int64_t first, std::int64_t items) {
        const plr_const_view records = pelorus::slice(args.record, first, items);
        for (const Model& model : models_) {
            plr_estimator_assign own = args;
            own.record = records_of(model, records);
            own.mean = pelorus::slice(args.mean, first, items);
            own.covariance = pelorus::slice(args.covariance, first, items);
            own.out = records_of(model, pelorus::slice(args.out, first, items));
            tolerate(model.part.call(&plr_estimator::assign, block, own));
        }
        return keep_weights(block, records, pelorus::slice(args.out, first, items));
    });
}

plr_status Filter::keep_weights(const plr_call& call, const plr_const_view& from, const plr_view& to) const {
    return for_good_items(call, to.count, [&](std::int64_t i) {
        const double* const weights = weights_of(from, i);
        if (weights != at(to, i)) std::copy_n(weights, count(), at(to, i));
    });
}

/// How likely the models are in a record. Throws NumericError unless they are numbers.
const double* Filter::weights_of(const plr_const_view& records, std::int64_t i) const {
    const double* const weights = at(records, i);
    if (!all_finite(weights, count())) throw pelorus::NumericError("the probabilities of the models are not finite");
    return weights;
}

plr_status Filter::probabilities(const plr_call& call, const plr_const_view& record, const plr_view& out) const {
    expect_packed(record, record_size_, 1, out.count, "record");
    expect_packed(out, count(), 1, out.count, "out");
    return pelorus::for_items(call, out.count,
                              [&](std::int64_t i) { std::copy_n(weights_of(record, i), count(), at(out, i)); });
}

template <bool assigns> void Imm<assigns>::describe(pelorus::Describe<Imm>& plugin) {
    plugin.title("Interacting multiple models")
        .purpose(
            "Several filters side by side, with models of their own (quiet flight, a manoeuvre), of which one at a "
            "time describes the target. Before each step their estimates are mixed by how likely the target is to have "
            "changed from one model to another; each measurement says how likely each model is.")
        .equation(
            "c_j = sum p_ij mu_i; filter j starts from the mixture with weights p_ij mu_i / c_j; mu_j = c_j L_j / sum "
            "c_k L_k; p_ii(T) = 1/r + (1 - 1/r) ((stay - 1/r)/(1 - 1/r))^(T / 1 s), the others share the rest")
        .source(
            "H. A. P. Blom, Y. Bar-Shalom, The interacting multiple model algorithm for systems with Markovian "
            "switching coefficients, IEEE Transactions on Automatic Control 33(8), 780-783, 1988");
    plugin.slot("estimators", "estimator", 1, -1,
                "a filter for each model, with the same sensors; each under the name of its model");
    plugin.parameter("stay", &Imm::stay_)
        .initially("0.95")
        .above(0)
        .max(1)
        .doc("probability that the target keeps to its model for a second; 1: it never changes");
}

template <bool assigns> void Imm<assigns>::setup(const pelorus::Setup& setup) {
    this->build(setup);
    this->info = this->told();
    modes_ = {sizeof(plr_estimator_modes), static_cast<std::int32_t>(this->names().size()), this->names().data(),
              [](const void* self, const plr_call* call, const plr_const_view* record, const plr_view* out) {
                  return pelorus::guarded(
                      call->error, [&] { return static_cast<const Imm*>(self)->probabilities(*call, *record, *out); });
              }};
}

template <bool assigns> const void* Imm<assigns>::extension(const char* id) const noexcept {
    return std::strcmp(id, PLR_ESTIMATOR_MODES) == 0 ? &modes_ : nullptr;
}

template class Imm<true>;
template class Imm<false>;

}  // namespace imm
