#include <gtest/gtest.h>

#include <stdexcept>

#include "pipeline/memory_model.h"

namespace morphodesic::pipeline {
namespace {

TEST(MemoryModel, GrowsWithTheGridTheStepsAndTheDimension) {
    EXPECT_NEAR(static_cast<double>(bytes_of_pair(2, 8, 8)) / static_cast<double>(bytes_of_pair(2, 7, 8)), 4, 0.1);
    EXPECT_NEAR(static_cast<double>(bytes_of_pair(3, 7, 8)) / static_cast<double>(bytes_of_pair(3, 6, 8)), 8, 0.3);
    EXPECT_GT(bytes_of_pair(2, 6, 8), 19 * bytes_of_pair(2, 6, 4) / 10);
}

TEST(MemoryModel, PairsAndShapesShareWhatThereIs) {
    const std::size_t pair = bytes_of_pair(3, 6, 4) + 2 * bytes_of_shape(3, 6);
    const auto limit = [&](double pairs) {
        return std::to_string(bytes_of_program + static_cast<std::size_t>(pairs * static_cast<double>(pair)));
    };
    EXPECT_EQ(plan_memory(limit(3.1), 3, 6, 6, 4, 10, 8).pairs_in_flight, 3);
    EXPECT_EQ(plan_memory(limit(30), 3, 6, 6, 4, 10, 8).pairs_in_flight, 8);
    EXPECT_THROW((void)plan_memory(limit(0.9), 3, 6, 6, 4, 10, 8), std::invalid_argument);
    const MemoryPlan many = plan_memory(limit(2.5), 3, 6, 6, 4, 100000, 2);
    EXPECT_LT(many.shapes, many.all_shapes);
    EXPECT_LE(many.predicted, many.limit);
}

}  // namespace
}  // namespace morphodesic::pipeline
