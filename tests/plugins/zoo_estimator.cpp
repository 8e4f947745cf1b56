// The zoo's estimator: hands everything on to the one in its slot, with a misdeed.
#include "zoo.hpp"

namespace {

struct ZooEstimator : pelorus::Estimator<ZooEstimator> {
    using Base = pelorus::Estimator<ZooEstimator>;
    zoo::Fault fault = zoo::Fault::none;
    std::string in;
    pelorus::EstimatorPart inner;

    static void describe(pelorus::Describe<ZooEstimator>& plugin) {
        plugin.title("An estimator of the zoo");
        plugin.slot("inner", "estimator", 1, 1, "what does the work");
        zoo::describe(plugin);
    }
    void setup(const pelorus::Setup& setup) {
        inner = setup.part<pelorus::EstimatorPart>("inner");
        info = inner.info();
    }

    plr_status init(const plr_call& call, const plr_estimator_init& args) const {
        return inner.call(&plr_estimator::init, call, args);
    }
    plr_status predict(const plr_call& call, const plr_estimator_predict& args) const {
        return inner.call(&plr_estimator::predict, call, args);
    }
    plr_status project(const plr_call& call, const plr_estimator_project& args) const {
        return inner.call(&plr_estimator::project, call, args);
    }
    plr_status update(const plr_call& call, const plr_estimator_update& args) const {
        return inner.call(&plr_estimator::update, call, args);
    }
    plr_status summary(const plr_call& call, const plr_estimator_moments& args) const {
        return inner.call(&plr_estimator::summary, call, args);
    }
    plr_status moments(const plr_call& call, const plr_estimator_moments& args) const {
        return inner.call(&plr_estimator::moments, call, args);
    }
    plr_status assign(const plr_call& call, const plr_estimator_assign& args) const {
        return inner.call(&plr_estimator::assign, call, args);
    }

    static const ZooEstimator& of(const void* self) { return *static_cast<const ZooEstimator*>(self); }
    static plr_status init_entry(const void* self, const plr_call* call, const plr_estimator_init* args) {
        return zoo::act(of(self), "init", call, args->mean, args->record,
                        [&] { return Base::table().init(self, call, args); });
    }
    static plr_status predict_entry(const void* self, const plr_call* call, const plr_estimator_predict* args) {
        return zoo::act(of(self), "predict", call, args->dt, args->out,
                        [&] { return Base::table().predict(self, call, args); });
    }
    static plr_status project_entry(const void* self, const plr_call* call, const plr_estimator_project* args) {
        return zoo::act(of(self), "project", call, args->record, args->covariance,
                        [&] { return Base::table().project(self, call, args); });
    }
    static plr_status update_entry(const void* self, const plr_call* call, const plr_estimator_update* args) {
        return zoo::act(of(self), "update", call, args->measurement, args->out,
                        [&] { return Base::table().update(self, call, args); });
    }
    static plr_status summary_entry(const void* self, const plr_call* call, const plr_estimator_moments* args) {
        return zoo::act(of(self), "summary", call, args->record, args->mean,
                        [&] { return Base::table().summary(self, call, args); });
    }
    static const plr_estimator& table() {
        static const plr_estimator zoo = [] {
            plr_estimator t = Base::table();
            t.head.destroy = &zoo::destroy<ZooEstimator>;
            t.init = &init_entry;
            t.predict = &predict_entry;
            t.project = &project_entry;
            t.update = &update_entry;
            t.summary = &summary_entry;
            return t;
        }();
        return zoo;
    }
};

}  // namespace

ZOO_PLUGIN(ZooEstimator, "org.example.estimator.zoo");
