/// What the opaque handles of embed.h are.
#pragma once

#include <atomic>
#include <map>
#include <memory>

#include <pelorus/embed.h>

#include "embed/pipeline.hpp"

struct pelorus_subscription {
    pelorus_pipeline* pipeline = nullptr;
    pelorus::embed::Subscription* queue = nullptr;
};

struct pelorus_pipeline {
    pelorus_pipeline(const pelorus::graph::Document& document, const pelorus::embed::Options& options)
        : own(document, options) {}
    pelorus::embed::Pipeline own;
    std::map<const pelorus_subscription*, std::unique_ptr<pelorus_subscription>> subscriptions;
    std::atomic<bool> busy{false};
};
