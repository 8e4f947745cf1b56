// Nearly constant velocity in three dimensions, with what may be wrong in what a plugin says of its parameters.
#include "constant_velocity.hpp"
#include "defect.h"

namespace {

enum class Form { white, wiener };

struct Saboteur : ConstantVelocity<Saboteur> {
    std::optional<double> decay;
    Form form = Form::white;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        pelorus::ParameterBuilder first = describe_as(plugin);
        first.max(1e4);
        if (DEFECT("defaults-are-read")) first.initially("20000 m2/s3");
        if (NEAR_MISS("defaults-are-read")) first.initially("10000 m2/s3");
        if (DEFECT("description-is-accepted")) first.min(1e5);
        if (NEAR_MISS("description-is-accepted")) first.min(1).max(1);
        if (DEFECT("description-is-complete")) first.doc("");
        if (NEAR_MISS("description-is-complete")) plugin.purpose("Moves.").source("");  // there is none
        plugin.parameter("decay", &Saboteur::decay)
            .unit(DEFECT("units-are-read")      ? "1/sec"
                  : NEAR_MISS("units-are-read") ? "1/s"
                                                : "Hz")
            .doc("rate at which nothing decays");
        plugin.parameter("form", &Saboteur::form)
            .initially("white")
            .choices({{"white", "white acceleration"},
                      {DEFECT("values-can-be-written")      ? "null"
                       : NEAR_MISS("values-can-be-written") ? "off"
                                                            : "wiener",
                       "the same by another name"}})
            .doc("how the noise is called");
    }
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.motion.saboteur_of_parameters");
