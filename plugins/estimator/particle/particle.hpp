/// estimator.particle: the bootstrap particle filter. See README.md.
///
/// The record of a track: [draws so far, logarithms of the weights (N), particles (n x N), the motion's record].
#pragma once

#include <vector>

#include <pelorus/batch_model.hpp>
#include <pelorus/small_matrix.hpp>

#include "../../common/batches/batches.hpp"

namespace particle {

constexpr int max_state = 12, max_measurement = 6, max_particles = 4096;
using Square = pelorus::small::Bounded<max_state, max_state>;
using Column = pelorus::small::Bounded<max_state, 1>;

/// A sensor of the slot, and where among the Cartesian components it finds what it looks at.
struct SensorInSlot {
    pelorus::SensorPart part;
    std::int64_t m = 0, c = 0;
    std::vector<std::int64_t> index;  // [c]
    std::vector<int> angles;          // of the measurement
};

class Particle : public pelorus::Estimator<Particle> {
public:
    static constexpr bool assignable = false;

    static void describe(pelorus::Describe<Particle>& plugin);
    void setup(const pelorus::Setup& setup);

    plr_status init(const plr_call& call, const plr_estimator_init& args) const;
    plr_status predict(const plr_call& call, const plr_estimator_predict& args) const;
    plr_status project(const plr_call& call, const plr_estimator_project& args) const;
    plr_status update(const plr_call& call, const plr_estimator_update& args) const;
    plr_status summary(const plr_call& call, const plr_estimator_moments& args) const;
    plr_status moments(const plr_call& call, const plr_estimator_moments& args) const;

private:
    /// The fields of one record.
    template <class Double> struct Cloud { Double *draws, *log_weights, *points, *motion; };
    template <class Double> Cloud<Double> cloud(Double* record) const noexcept {
        return {record, record + 1, record + 1 + size_, record + 1 + size_ + n_ * size_};
    }
    /// Scratch memory of a call, for one track at a time.
    struct Memory {
        double* weights;    // N
        double* cartesian;  // c x N
        double* seen;       // m x N: what the sensor would measure of each
        double* apart;      // m x N: differences of that
        double* moved;      // n x N
        double* block;      // for blocks of particles
    };
    Memory memory(double* data) const noexcept;
    std::int64_t memory_doubles() const noexcept;
    /// The context for a part's call about the particles of one track: all of them share its inputs.
    struct PartCall {
        PartCall(const plr_call& call, std::int64_t item);
        PartCall(const PartCall&) = delete;
        PartCall& operator=(const PartCall&) = delete;
        /// Throws NumericError (or what the part told) unless it went well.
        void require(plr_status status) const;
        plr_call call;

    private:
        plr_error error_{};
    };

    void add_sensor(const pelorus::SensorPart& part);
    void expect_sound(const double* record) const;
    const SensorInSlot& sensor(std::int32_t index) const;
    plr_key draw(const plr_call& call, std::int64_t item, double* draws) const;

    void start_item(const plr_call& call, const plr_estimator_init& args, std::int64_t item, double* block) const;
    void start_motion(const PartCall& part, const Cloud<double>& to) const;

    /// One track's step.
    struct Step {
        double dt;
        plr_const_view extent;
        plr_key key;
    };
    /// The factor G of a process noise that all particles share, and what it was made from.
    struct Shared {
        bool is_shared = true;
        Column mean;
        Square covariance, factor;
    };
    void move_item(const plr_call& call, const plr_estimator_predict& args, std::int64_t item,
                   const Memory& memory) const;
    void propagate(const PartCall& part, double dt, const double* points, std::int64_t count, const double* record,
                   double* out) const;
    void ask_noise(const PartCall& part, const Step& step, const plr_const_view& state,
                   const plr_const_view& covariance, const plr_const_view& predicted, const double* record,
                   double* out) const;
    void share_noise(const PartCall& part, const Step& step, const Cloud<double>& of, const Memory& memory,
                     Shared& shared) const;
    void factorise(const double* noise, Square& factor) const;
    void add_noise(const PartCall& part, const Step& step, const Cloud<double>& of, const Shared& shared,
                   const Memory& memory) const;

    const double* to_cartesian(const PartCall& part, const double* points, const Memory& memory) const;
    void look(const PartCall& part, const SensorInSlot& by, const double* points, const Memory& memory) const;
    void tell_seen(const PartCall& part, const SensorInSlot& by, const Memory& memory, double* mean,
                   double* covariance) const;
    void differences(const PartCall& part, const SensorInSlot& by, const plr_const_view& measurement,
                     const plr_const_view& reference, double* out) const;
    void project_item(const plr_call& call, const plr_estimator_project& args, std::int64_t item,
                      const Memory& memory) const;
    void update_item(const plr_call& call, const plr_estimator_update& args, std::int64_t item,
                     const Memory& memory) const;
    void tell_innovation(const PartCall& part, const SensorInSlot& by, const plr_estimator_update& args,
                         std::int64_t item, const Memory& memory) const;
    double weigh(const PartCall& part, const SensorInSlot& by, const double* measurement, const double* noise,
                 const Cloud<double>& of, const Memory& memory) const;
    double effective_size(const Cloud<double>& of) const noexcept;
    void resample(plr_key key, const Cloud<double>& of, const Memory& memory) const;
    void roughen(plr_key key, const Cloud<double>& of) const;
    void tell_item(const plr_call& call, const plr_estimator_moments& args, std::int64_t item, bool is_cartesian,
                   const Memory& memory) const;
    plr_status tell(const plr_call& call, const plr_estimator_moments& args, bool is_cartesian) const;

    int particles_ = 0;
    double resample_below_ = 0.5, roughening_ = 0;

    const plr_random* random_ = nullptr;
    pelorus::MotionPart motion_;
    std::vector<SensorInSlot> sensors_;
    pelorus::Space state_, cartesian_;
    std::vector<int> state_angles_, cartesian_angles_;
    const plr_motion_noise_factor* factor_ = nullptr;
    std::int64_t n_ = 0, c_ = 0, size_ = 0, motion_record_ = 0, most_measured_ = 0, most_seen_ = 0, drawn_ = 0;
    bool state_is_cartesian_ = true, noise_is_constant_ = true;
};

}  // namespace particle
