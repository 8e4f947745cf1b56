// scheduler.waveform: chooses a sensor's next waveform from the prediction of a track. See README.md.
#include "waveform_scheduler.hpp"

PELORUS_PLUGIN(waveform_scheduler::WaveformScheduler, "scheduler.waveform");
