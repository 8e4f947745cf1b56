// partitioner.kmeans_plus_plus: cells about as many centres as wanted, or as many as a criterion finds best. See README.md.
#include "kmeans_plus_plus.hpp"

PELORUS_PLUGIN(kmeans_plus_plus::KMeansPlusPlus, "partitioner.kmeans_plus_plus");
