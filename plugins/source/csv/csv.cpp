// source.csv as a plugin. See README.md.
#include "csv_source.hpp"

PELORUS_PLUGIN(source_csv::CsvSource, "source.csv");
