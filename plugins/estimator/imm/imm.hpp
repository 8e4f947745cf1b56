/// estimator.imm: several filters side by side, of which one describes the target at a time. See README.md.
///
/// The record of a track: [probabilities of the models (r), with a warm-up the age (s), the record of each].
#pragma once

#include <vector>

#include <pelorus/batch_model.hpp>

#include "../../common/batches/batches.hpp"
#include "chain.hpp"

namespace imm {

using namespace batches;

/// The components of all models together.
struct JoinedSpace {
    pelorus::Space space;
    std::vector<Place> places;  ///< of each model
    std::vector<int> angles;
    Gaussian<max_state> prior;
    bool is_shared = true;  ///< all models have all of them, in the same order

    JoinedSpace() = default;
    explicit JoinedSpace(const std::vector<pelorus::Space>& spaces);
    int size() const noexcept { return space.size(); }
};

/// The filter; Imm below makes a plugin of it.
class Filter {
public:
    plr_status init(const plr_call& call, const plr_estimator_init& args) const;
    plr_status predict(const plr_call& call, const plr_estimator_predict& args) const;
    plr_status project(const plr_call& call, const plr_estimator_project& args) const;
    plr_status update(const plr_call& call, const plr_estimator_update& args) const;
    plr_status summary(const plr_call& call, const plr_estimator_moments& args) const;
    plr_status moments(const plr_call& call, const plr_estimator_moments& args) const;
    plr_status assign(const plr_call& call, const plr_estimator_assign& args) const;
    plr_status probabilities(const plr_call& call, const plr_const_view& record, const plr_view& out) const;

protected:
    void build(const pelorus::Setup& setup);
    plr_estimator_info told() const;
    bool is_assignable() const noexcept { return state_.is_shared && cartesian_.is_shared; }
    const std::vector<const char*>& names() const noexcept { return names_; }

    double stay_ = 0.95;
    std::optional<double> warm_up_;  // s

private:
    struct Model {
        pelorus::EstimatorPart part;
        std::int64_t n = 0, c = 0, record = 0, offset = 0;  ///< offset: of its record in ours
        std::vector<std::int32_t> sensors;                  ///< its index of each of our sensors
    };
    struct SeenBy {
        std::int64_t m = 0;
        std::vector<int> angles;
        pelorus::SensorPart part;
    };
    /// Where the cross-covariances of a block go, one model after the other; each may be nullptr.
    struct Crosses {
        double *state = nullptr, *cartesian = nullptr;
        template <class Double> static Double* of(Double* all, std::size_t model, std::int64_t m) noexcept {
            return all + static_cast<std::int64_t>(model) * block_size * max_state * m;
        }
    };
    /// What the models answered of a block: measurements, cross-covariances, moments.
    struct Looked {
        const double *looks, *crosses, *states;
    };

    void check_chain(std::size_t models);
    void add_sensors(const std::vector<pelorus::EstimatorPart>& parts);
    /// Doubles of a record before those of the models.
    int head() const noexcept { return count() + (warm_up_ ? 1 : 0); }
    int count() const noexcept { return static_cast<int>(models_.size()); }
    const SeenBy& sensor(std::int32_t index) const;
    template <class View> View records_of(const Model& model, const View& records) const noexcept {
        return field(records, model.offset, model.record, 1);
    }
    std::uint64_t scratch_needed() const;
    std::int64_t moment_doubles(bool is_cartesian) const;

    plr_status tell_moments(const plr_call& call, const JoinedSpace& joined, bool is_cartesian,
                            const plr_estimator_moments& args) const;
    void ask_moments(const plr_call& block, const plr_const_view& records, bool is_cartesian, double* memory) const;
    void load(const JoinedSpace& joined, bool is_cartesian, const double* memory, std::int64_t item,
              Gaussian<max_state>* out) const;
    plr_status keep_heads(const plr_call& call, const plr_const_view& from, const plr_view& to) const;
    const double* weights_of(const plr_const_view& records, std::int64_t i) const;

    plr_status stand(const plr_call& call, const plr_estimator_predict& args) const;
    plr_status move(const plr_call& call, const plr_estimator_predict& args) const;
    void mix(double dt, const double* head, double* memory, std::int64_t item, double* after) const;
    void assign_models(const plr_call& block, const plr_estimator_predict& args, double* memory) const;
    void predict_models(const plr_call& call, const plr_estimator_predict& args, const plr_const_view& from) const;

    void look(const plr_call& block, std::int32_t index, const plr_const_view& records, double* memory,
              const Crosses& crosses) const;
    void load_looks(const SeenBy& by, const double* memory, std::int64_t item, Gaussian<max_measurement>* out) const;
    void tell_cross(const SeenBy& by, bool is_cartesian, const Looked& looked, const double* weights, std::int64_t item,
                    double* out) const;
    void update_models(const plr_call& block, const plr_estimator_update& args, double* likelihoods) const;
    void tell_innovation(const plr_call& block, const plr_estimator_update& args, double* memory) const;
    void weigh(const double* before, const double* log_likelihoods, double* after, double& told) const;

    Chain chain_;
    std::vector<Model> models_;
    std::vector<SeenBy> sensors_;
    JoinedSpace state_, cartesian_;
    std::vector<const char*> names_;
    std::int64_t record_size_ = 0;
};

/// `assigns`: its moments may be set, because all models have the same components.
template <bool assigns> class Imm : public Filter, public pelorus::Estimator<Imm<assigns>> {
public:
    static constexpr bool assignable = assigns;

    static void describe(pelorus::Describe<Imm>& plugin);
    void setup(const pelorus::Setup& setup);
    const void* extension(const char* id) const noexcept;
    using Filter::stay_;
    using Filter::warm_up_;

    // The table wants members of this very class.
    plr_status init(const plr_call& call, const plr_estimator_init& args) const { return Filter::init(call, args); }
    plr_status predict(const plr_call& call, const plr_estimator_predict& args) const {
        return Filter::predict(call, args);
    }
    plr_status project(const plr_call& call, const plr_estimator_project& args) const {
        return Filter::project(call, args);
    }
    plr_status update(const plr_call& call, const plr_estimator_update& args) const {
        return Filter::update(call, args);
    }
    plr_status summary(const plr_call& call, const plr_estimator_moments& args) const {
        return Filter::summary(call, args);
    }
    plr_status moments(const plr_call& call, const plr_estimator_moments& args) const {
        return Filter::moments(call, args);
    }
    plr_status assign(const plr_call& call, const plr_estimator_assign& args) const {
        return Filter::assign(call, args);
    }

private:
    plr_estimator_modes modes_{};
};

}  // namespace imm
