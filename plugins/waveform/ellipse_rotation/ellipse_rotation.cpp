// waveform.ellipse_rotation: turns the measurement ellipse across the predicted one. See README.md.
#include "ellipse_rotation.hpp"

PELORUS_PLUGIN(ellipse_rotation::EllipseRotation, "waveform.ellipse_rotation");
