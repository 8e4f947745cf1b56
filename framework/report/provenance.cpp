#include "report/provenance.hpp"

#include <gnu/libc-version.h>

namespace pelorus::report {
namespace {

using Json = nlohmann::ordered_json;

/// The instruction set that the host was compiled for. Plugins may be compiled for another; their SHA-256 stands for
/// that.
std::string compiled_isa() {
#if defined(__x86_64__)
    std::string isa = "x86-64";
#if defined(__AVX512F__)
    isa += "+avx512f";
#elif defined(__AVX2__)
    isa += "+avx2";
#elif defined(__AVX__)
    isa += "+avx";
#endif
#if defined(__FMA__)
    isa += "+fma";
#endif
    return isa;
#elif defined(__aarch64__)
    return "aarch64";
#else
    return "unknown";
#endif
}

/// What the processor offers of the features by which the mathematical library chooses its functions: sin and exp
/// differ in the last digit with and without fused multiply-add.
Json processor_features() {
    Json features = Json::array();
#if defined(__x86_64__)
    __builtin_cpu_init();
    if (__builtin_cpu_supports("sse4.2")) features.push_back("sse4.2");
    if (__builtin_cpu_supports("avx")) features.push_back("avx");
    if (__builtin_cpu_supports("avx2")) features.push_back("avx2");
    if (__builtin_cpu_supports("fma")) features.push_back("fma");
    if (__builtin_cpu_supports("avx512f")) features.push_back("avx512f");
#endif
    return features;
}

std::string compiler() {
#if defined(__clang__)
    return std::string("clang ") + __clang_version__;
#else
    return std::string("gcc ") + __VERSION__;
#endif
}

}  // namespace

Json build_facts() {
    return {{"pelorus", PELORUS_VERSION},
            {"abi", {{"major", PLR_ABI_MAJOR}, {"minor", PLR_ABI_MINOR}}},
            {"compiler", compiler()},
            {"isa", {{"compiled", compiled_isa()}, {"processor", processor_features()}}},
            {"libc", std::string("glibc ") + gnu_get_libc_version()}};
}

Json plugins_json(const std::vector<const host::LoadedPlugin*>& plugins) {
    Json list = Json::array();
    for (const host::LoadedPlugin* plugin : plugins)
        list.push_back({{"id", plugin->file.id}, {"version", plugin->file.version}, {"sha256", plugin->sha256()}});
    return list;
}

Json provenance(const graph::Graph& graph, const RunContext& context) {
    Json document{
        {"config_file", context.config}, {"title", graph.title()}, {"seed", graph.seed()}, {"runs", context.runs}};
    if (graph.run() != 0) document["run"] = graph.run();
    document["completed"] = !context.stopped;
    document["host"] = build_facts();
    document["plugins"] = plugins_json(context.plugins.empty() ? graph.plugins() : context.plugins);
    if (!context.campaign.is_null()) document["campaign"] = context.campaign;
    document["config"] = graph.resolved();
    return document;
}

}  // namespace pelorus::report
