// A saboteur is a good plugin with one defect. Each source here is compiled once; each defect that it names becomes a library of its
// own (and each near-miss), by a constant that is linked in. The suites must catch DEFECT("name") by the check of that name, each
// DEFECT("name.variant") as well, and let NEAR_MISS("name") pass: the same code, as close to the law's limit as is still lawful.
#ifndef PELORUS_SABOTEUR_DEFECT_H
#define PELORUS_SABOTEUR_DEFECT_H

#include <string.h>

#ifdef __cplusplus
extern "C"
#else
extern
#endif
    const char saboteur_defect[];

static inline int saboteur_is(const char* name) { return strcmp(saboteur_defect, name) == 0; }

#define DEFECT(check) saboteur_is(check)
#define NEAR_MISS(check) saboteur_is("near:" check)

#endif
