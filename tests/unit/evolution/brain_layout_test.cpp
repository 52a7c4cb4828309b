#include "server/evolution/brain_layout.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace evod::evolution {
namespace {

using Names = std::vector<std::string>;

Parameters network() {
    Parameters parameters;
    parameters.controller = Controller::Network;
    return parameters;
}

TEST(BrainLayout, RulesHaveNoBrain) {
    EXPECT_EQ(brain_layout({}), BrainLayout{});
    EXPECT_EQ(brain_layout({}).weight_count(), 0u);
    EXPECT_EQ(brain_gene_names({}), Names{});
}

TEST(BrainLayout, NamesSayWhatWeightsConnectInTheirOrder) {
    Parameters parameters = network();
    parameters.brain_hidden = 2;
    parameters.sense_poison = false;
    EXPECT_EQ(brain_gene_names(parameters),
              (Names{"hidden1<food_bearing", "hidden1<food_proximity", "hidden1<bias", "hidden2<food_bearing",
                     "hidden2<food_proximity", "hidden2<bias", "thrust<hidden1", "thrust<hidden2", "thrust<bias",
                     "turn<hidden1", "turn<hidden2", "turn<bias"}));
}

TEST(BrainLayout, KinematicBearingOnlyWithoutBias) {
    Parameters parameters = network();
    parameters.brain_hidden = 1;
    parameters.sense_poison = false;
    parameters.sense_bearing_only = true;
    parameters.brain_bias = false;
    parameters.locomotion = Locomotion::Kinematic;
    EXPECT_EQ(brain_gene_names(parameters), (Names{"hidden1<food_bearing", "acceleration<hidden1", "turn<hidden1"}));
}

TEST(BrainLayout, EverySenseIsAnInputInOrder) {
    Parameters parameters = network();
    parameters.sense_speed = parameters.sense_health = parameters.sense_wall = true;
    const BrainLayout layout = brain_layout(parameters);
    ASSERT_EQ(layout.inputs.size(), brain_input_names.size());
    for (std::size_t i = 0; i < layout.inputs.size(); ++i) {
        EXPECT_EQ(static_cast<std::size_t>(layout.inputs[i]), i);
    }
}

TEST(BrainLayout, EveryWeightHasADifferentName) {
    for (const std::uint32_t hidden : {1u, 5u, brain_hidden_max}) {
        for (const bool bias : {false, true}) {
            Parameters parameters = network();
            parameters.brain_hidden = hidden;
            parameters.brain_bias = bias;
            parameters.sense_wall = true;
            const BrainLayout layout = brain_layout(parameters);
            Names names = brain_gene_names(parameters);
            EXPECT_EQ(names.size(), layout.weight_count());
            std::sort(names.begin(), names.end());
            EXPECT_EQ(std::unique(names.begin(), names.end()), names.end());
        }
    }
}

TEST(BrainLayout, WeightsStayInTheRangeOfTheParameters) {
    Parameters parameters = network();
    parameters.brain_weight_limit = 3;
    parameters.brain_weight_initial = 0.5;
    EXPECT_EQ(brain_genes(parameters).limit, 3);
    EXPECT_EQ(brain_genes(parameters).initial, 0.5f);
}

} // namespace
} // namespace evod::evolution
