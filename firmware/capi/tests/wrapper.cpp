// The first command of examples/c/first.c by the C++ wrapper.
#include "cede.hpp"
#include <cstdio>
#include <type_traits>

static_assert(!std::is_copy_constructible_v<cede::approach>);
static_assert(!std::is_move_constructible_v<cede::junction>);

int main()
{
    const cede_point mine[] = {{-40.0f, -2.0f}, {-6.0f, -2.0f}, {0.0f, 0.0f}, {2.0f, 6.0f}, {2.0f, 40.0f}};
    const cede_point theirs[] = {{40.0f, 2.0f}, {-40.0f, 2.0f}};
    const cede_footprint car{4.6f, 1.9f};
    static cede::policy policy;
    static cede::drive drive;
    static cede::junction junction;
    static cede::approach approach;
    cede_contract contract;
    uint8_t left = 0, oncoming = 0;

    bool done = cede_contract_worst_case(&contract) == CEDE_STATUS_OK && policy.init_embedded() == CEDE_STATUS_OK;
    contract.ego_braking = 9.0f;
    const cede::result refused = drive.init(policy, contract, cede::part::left);
    done = done && !refused && refused.detail().contract_field == CEDE_CONTRACT_FIELD_EGO_BRAKING;
    contract.ego_braking = 4.0f;
    done = done && drive.init(policy, contract, cede::part::left) && junction.init() == CEDE_STATUS_OK &&
           junction.add_path(mine, cede::vehicle_class::car, car, left) &&
           junction.add_path(theirs, cede::vehicle_class::car, car, oncoming) &&
           junction.set_priority(oncoming, left, CEDE_PRIORITY_SIGNED) && junction.set_control(left, CEDE_CONTROL_YIELD) &&
           junction.build() && approach.enter(drive, junction, left);

    cede_track other{};
    other.number = 17;
    other.candidate_count = 1;
    other.speed = 8.0f;
    other.pose = {{20.0f, 2.0f}, {-1.0f, 0.0f}};
    other.candidates[0].s = 20.0f;
    other.candidates[0].path = oncoming;
    const cede_observation seen{{15.0f, 6.0f, {{-25.0f, -2.0f}, {1.0f, 0.0f}}}, &other, 1};
    cede_decision decision;
    done = done && approach.ready(1000000, seen) == CEDE_STATUS_OK &&
           approach.decide(1000000, seen, decision) == CEDE_STATUS_OK &&
           approach.decide_up_to(1100000, 0.5f, seen, decision) == CEDE_STATUS_OK;
    std::printf("C++: %s\n", done ? cede_cause_text(decision.cause) : "failed");
    return done ? 0 : 1;
}
