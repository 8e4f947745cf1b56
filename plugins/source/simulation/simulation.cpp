// source.simulation: trajectories seen by sensor models. See README.md.
#include "simulation.hpp"

PELORUS_PLUGIN(simulation::Simulation, "source.simulation");
