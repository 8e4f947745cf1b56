/* What a library may do wrong before a plugin of it is made. Such defects lie in data, symbols and link options, so this source
 * is compiled once for each DEFECT_name and NEAR_MISS_name that stands in it, with that macro defined (names of checks with _ for
 * -), and linked with the plugin of model.cpp. Link options: options.cmake. */
#include <pelorus/abi/entry.h>
#include <pelorus/abi/motion.h>

#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define OWN_ID "org.example.motion.saboteur"

const plr_plugin* saboteur_plugin(const char* wanted);
const plr_plugin* other_saboteur_plugin(const char* id, const char* wanted);

/* The manifest. */

#if defined(DEFECT_library_manifest_readable)
/* An id without its terminating zero: it runs into the next field. */
__attribute__((section(PLR_MANIFEST_SECTION), used)) static const plr_manifest manifest = {
    PLR_MANIFEST_MAGIC,
    (uint32_t)sizeof(plr_manifest),
    PLR_ABI_MAJOR,
    PLR_ABI_MINOR,
    "org.example.motion.saboteur_saboteur_saboteur_saboteur_saboteur_saboteur_saboteur_saboteur_saboteur_saboteur_"
    "saboteur_saboteur_s",
    "motion",
    PLR_MOTION,
    "1.0.0"};
#elif defined(NEAR_MISS_library_manifest_readable)
/* A manifest of a later minor version: longer at the tail. */
static const struct {
    plr_manifest known;
    char later[16];
} manifest __attribute__((section(PLR_MANIFEST_SECTION), used)) = {
    {PLR_MANIFEST_MAGIC, (uint32_t)sizeof(plr_manifest) + 16, PLR_ABI_MAJOR, PLR_ABI_MINOR, OWN_ID, "motion",
     PLR_MOTION, "1.0.0"},
    "later"};
#elif defined(DEFECT_library_descriptor_equals_manifest)
PLR_MANIFEST(OWN_ID, "motion", PLR_MOTION, "1.0.1"); /* the description was forgotten when the version was raised */
#elif defined(DEFECT_library_loads) || defined(NEAR_MISS_library_loads)
#if defined(DEFECT_library_loads)
#define MAJOR (PLR_ABI_MAJOR + 1)
#define MINOR PLR_ABI_MINOR
#else
#define MAJOR PLR_ABI_MAJOR
#define MINOR (PLR_ABI_MINOR + 1)
#endif
__attribute__((section(PLR_MANIFEST_SECTION), used)) static const plr_manifest manifest = {
    PLR_MANIFEST_MAGIC, (uint32_t)sizeof(plr_manifest), MAJOR, MINOR, OWN_ID, "motion", PLR_MOTION, "1.0.0"};
#else
PLR_MANIFEST(OWN_ID, "motion", PLR_MOTION, "1.0.0");
#endif

/* The factory. */

#if defined(NEAR_MISS_library_unknown_ids_are_null) || defined(NEAR_MISS_library_answers_its_plugins)
/* A second plugin, whose id begins (ends) like the first one's. */
#if defined(NEAR_MISS_library_unknown_ids_are_null)
#define OTHER_ID "org.example.motion.saboteu"
#else
#define OTHER_ID OWN_ID ".another"
#endif
PLR_MANIFEST(OTHER_ID, "motion", PLR_MOTION, "1.0.0");
#endif

static const plr_plugin* factory(const char* id) {
#if defined(OTHER_ID)
    const plr_plugin* other = other_saboteur_plugin(OTHER_ID, id);
    if (other != NULL) return other;
#elif defined(DEFECT_library_answers_its_plugins)
    if (strcmp(id, "org.example.motion.sabotuer") == 0) return saboteur_plugin(OWN_ID);
    return NULL;
#elif defined(DEFECT_library_unknown_ids_are_null)
    if (strncmp(id, OWN_ID, strlen(id)) == 0) return saboteur_plugin(OWN_ID); /* the length of the wrong one */
#elif defined(DEFECT_library_factory_is_constant)
    const plr_plugin* own = saboteur_plugin(id);
    plr_plugin* answer = own == NULL ? NULL : malloc(sizeof *answer);
    if (answer != NULL) memcpy(answer, own, sizeof *answer);
    return answer;
#elif defined(NEAR_MISS_library_factory_is_constant)
    static plr_plugin answer; /* made on the first question, and longer than its creator knows */
    const plr_plugin* own = saboteur_plugin(id);
    if (own == NULL) return NULL;
    if (answer.create == NULL) answer = *own;
    return &answer;
#elif defined(NEAR_MISS_library_descriptor_equals_manifest)
    static plr_plugin answer;
    static plr_description description;
    static char kind[] = "motion", version[] = "1.0.0"; /* equal texts, not the same ones */
    const plr_plugin* own = saboteur_plugin(id);
    if (own == NULL) return NULL;
    if (answer.create == NULL) {
        description = *own->description;
        description.kind = kind;
        description.version = version;
        answer = *own;
        answer.description = &description;
    }
    return &answer;
#endif
    return saboteur_plugin(id);
}

/* What runs when it is loaded, started and ended. */

#if defined(DEFECT_library_loads_silently)
__attribute__((constructor)) static void greet(void) { puts("saboteur 1.0.0"); }
#elif defined(NEAR_MISS_library_loads_silently)
static char* table;
__attribute__((constructor)) static void prepare(void) { table = malloc(64); }
__attribute__((destructor)) static void tidy(void) { free(table); }
#elif defined(DEFECT_library_keeps_process_settings)
__attribute__((constructor)) static void ignore_signals(void) { signal(SIGUSR2, SIG_IGN); }
#elif defined(NEAR_MISS_library_keeps_process_settings)
__attribute__((constructor)) static void try_without_signals(void) {
    void (*const before)(int) = signal(SIGUSR2, SIG_IGN);
    signal(SIGUSR2, before);
}
#endif

#if defined(DEFECT_library_ends_well)
static char* volatile held;
static plr_status start(const plr_host* host, plr_error* error) {
    (void)host, (void)error;
    held = calloc(64, 1);
    return PLR_OK;
}
static void end(void) {
    free(held);
    held = NULL;
}
__attribute__((destructor)) static void tidy(void) { held[0] = 1; } /* it is gone */
#elif defined(NEAR_MISS_library_ends_well)
static pthread_t worker;
static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t changed = PTHREAD_COND_INITIALIZER;
static int is_over;
static void* work(void* nothing) {
    pthread_mutex_lock(&mutex);
    while (!is_over) pthread_cond_wait(&changed, &mutex);
    pthread_mutex_unlock(&mutex);
    return nothing;
}
static plr_status start(const plr_host* host, plr_error* error) {
    (void)host, (void)error;
    return pthread_create(&worker, NULL, &work, NULL) == 0 ? PLR_OK : PLR_E_MEMORY;
}
static void end(void) {
    pthread_mutex_lock(&mutex);
    is_over = 1;
    pthread_cond_signal(&changed);
    pthread_mutex_unlock(&mutex);
    pthread_join(worker, NULL);
}
#else
#define start NULL
#define end NULL
#endif

/* Symbols: what is exported or missing is said by options.cmake as well. */

#if defined(DEFECT_library_exports_one_symbol)
PLR_EXPORT int saboteur_version(void);
PLR_EXPORT int saboteur_version(void) { return 1; }
#elif defined(NEAR_MISS_library_exports_one_symbol)
/* A version of its own on the one symbol: see versioned.map. */
#elif defined(DEFECT_library_symbols_resolved)
extern int saboteur_forgotten_source(void);
int (*volatile saboteur_calls)(void) = &saboteur_forgotten_source;
#elif defined(NEAR_MISS_library_symbols_resolved)
extern __attribute__((weak)) int saboteur_optional_ability(void); /* used where there is one */
int (*volatile saboteur_calls)(void) = &saboteur_optional_ability;
#elif defined(DEFECT_library_stack_not_executable) || defined(NEAR_MISS_library_stack_not_executable) || \
    defined(DEFECT_library_search_path_is_absolute) || defined(NEAR_MISS_library_search_path_is_absolute)
/* Link options alone. */
#endif

#if defined(DEFECT_library_entry_is_whole)
#define SIZE 0
#elif defined(NEAR_MISS_library_entry_is_whole)
#define SIZE sizeof(plr_entry_point) + 16 /* of a later minor version */
#else
#define SIZE sizeof(plr_entry_point)
#endif
#if !defined(MAJOR)
#define MAJOR PLR_ABI_MAJOR
#define MINOR PLR_ABI_MINOR
#endif
PLR_EXPORT const plr_entry_point plr_entry = {SIZE, MAJOR, MINOR, start, end, &factory};
