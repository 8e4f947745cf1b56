/// trajectory.random_motion: true motion drawn from a motion model. See README.md.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "../../common/trajectories/life.hpp"

namespace random_motion {

class RandomMotion : public pelorus::Trajectory<RandomMotion>, public trajectories::Life {
public:
    static void describe(pelorus::Describe<RandomMotion>& plugin) {
        plugin.title("Motion drawn from a model")
            .purpose(
                "A point that moves as a motion model says, its process noise included: truth for tests in which a "
                "filter knows the model of its target exactly (consistency, posterior Cramer-Rao bound).")
            .equation(
                "x_0 = m + S u_0; x_k+1 = f(x_k) + L_k u_k+1 with L_k L_k' = Q, u standard normal; between steps f "
                "from the last one");
        plugin.slot("motion", "motion", 1, 1, "the model; one whose noise needs no record and no extent");
        plugin.parameter("start", &RandomMotion::start_).unit("m").rows(1, 3).doc("mean position at birth");
        plugin.parameter("velocity", &RandomMotion::velocity_)
            .unit("m/s")
            .rows(1, 3)
            .doc("mean velocity at birth; the model's prior mean if absent");
        plugin.parameter("acceleration", &RandomMotion::acceleration_)
            .unit("m/s2")
            .rows(1, 3)
            .doc("mean acceleration at birth, where the model has one; its prior mean if absent");
        plugin.parameter("start_deviation", &RandomMotion::start_deviation_)
            .unit("m, m/s, m/s2")
            .initially("0")
            .min(0)
            .doc("standard deviation at birth of each axis' position, velocity and acceleration");
        plugin.parameter("period", &RandomMotion::period_)
            .unit("s")
            .initially("1 s")
            .min(0.001)
            .doc("from step to step: the interval for which the process noise is drawn");
        describe_life(plugin);
    }

    void setup(const pelorus::Setup& setup);
    void realise(const plr_call& call, const plr_view& record) const;
    void states(const plr_call& call, const plr_trajectory_states& args) const;

private:
    static constexpr int most = 16;  // components of a state

    /// The states of one realisation, in ascending order of time.
    class Walk {
    public:
        Walk(const RandomMotion& owner, const plr_call& call, plr_key key);
        void tell(std::int64_t age, double* out);

    private:
        std::int64_t tick(std::int64_t step) const;
        void propagate(double dt, double* out) const;
        void step();

        const RandomMotion& of_;
        plr_call call_;
        plr_key key_;
        std::int64_t step_ = 0;
        std::array<double, most> state_{};
    };

    void find_components();
    void fill_start();
    std::size_t component(int derivative, int axis) const;

    std::vector<double> start_;
    std::optional<std::vector<double>> velocity_, acceleration_;
    pelorus::Vector<3> start_deviation_;
    double period_ = 1;  // s

    pelorus::MotionPart motion_;
    const plr_random* random_ = nullptr;
    pelorus::Space native_, cartesian_, space_;
    int axes_ = 0, derivatives_ = 0;
    std::vector<int> told_;                      // Cartesian component of each component of the truth
    std::vector<double> start_mean_, start_sd_;  // Cartesian
};

}  // namespace random_motion
