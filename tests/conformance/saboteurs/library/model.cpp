// Two good motions for libraries that have a defect of their own: see library.c.
#include "../constant_velocity.hpp"

namespace {

template <int Which> struct Model : ConstantVelocity<Model<Which>> {
    static void describe(pelorus::Describe<Model>& plugin) { Model::describe_as(plugin); }
};

}  // namespace

extern "C" {
const plr_plugin* saboteur_plugin(const char* wanted) noexcept;
const plr_plugin* other_saboteur_plugin(const char* id, const char* wanted) noexcept;
}

/// The plugin of the id that library.c has in its manifest, or NULL.
const plr_plugin* saboteur_plugin(const char* wanted) noexcept {
    return pelorus::detail::plugin<Model<1>>("org.example.motion.saboteur", wanted);
}

/// Another one under an id that the caller chooses.
const plr_plugin* other_saboteur_plugin(const char* id, const char* wanted) noexcept {
    return pelorus::detail::plugin<Model<2>>(id, wanted);
}
