// The C interface with C++ types: objects that cannot be copied or moved, and a result that must be looked at.
// No exceptions, no allocation: for -fno-exceptions as well. C++17.
#ifndef CEDE_HPP
#define CEDE_HPP

#include "cede.h"

namespace cede {

enum class vehicle_class : uint8_t { car = CEDE_CLASS_CAR, lorry = CEDE_CLASS_LORRY, bicycle = CEDE_CLASS_BICYCLE };
enum class part : uint8_t { left = CEDE_PART_LEFT, other = CEDE_PART_OTHER };

// What became of a call, with what a refusal is about.
class [[nodiscard]] result {
public:
    result(cede_status status, const cede_detail &detail) : status_(status), detail_(detail) {}
    explicit operator bool() const { return status_ == CEDE_STATUS_OK; }
    cede_status status() const { return status_; }
    const cede_detail &detail() const { return detail_; }
    const char *text() const { return cede_status_text(status_); }

private:
    cede_status status_;
    cede_detail detail_;
};

// A C object where it is; to be made before it is used.
template <typename Storage> class object {
public:
    object() = default;
    object(const object &) = delete;
    object &operator=(const object &) = delete;
    Storage *get() { return &storage_; }
    const Storage *get() const { return &storage_; }

protected:
    template <typename Function, typename... Arguments> static result call(Function function, Arguments... arguments) {
        cede_detail detail{};
        const cede_status status = function(arguments..., &detail);
        return {status, detail};
    }

private:
    Storage storage_{};
};

class policy : public object<cede_policy> {
public:
    [[nodiscard]] cede_status init(const uint32_t *weights, uint32_t bytes) { return cede_policy_init(get(), weights, bytes); }
    [[nodiscard]] cede_status init_embedded() { return cede_policy_init_embedded(get()); }
    [[nodiscard]] cede_status check() const { return cede_policy_check(get()); }
    [[nodiscard]] cede_status known_answer(cede_junction &junction, cede_approach &approach, uint32_t &answer) const {
        return cede_known_answer(get(), &junction, &approach, &answer);
    }
};

class drive : public object<cede_drive> {
public:
    result init(const policy &policy, const cede_contract &contract, part part) {
        return call(cede_drive_init, get(), policy.get(), &contract, static_cast<uint8_t>(part));
    }
};

class junction : public object<cede_junction> {
public:
    [[nodiscard]] cede_status init() { return cede_junction_init(get()); }
    template <uint32_t Count>
    result add_path(const cede_point (&points)[Count], vehicle_class kind, const cede_footprint &footprint, uint8_t &path) {
        return call(cede_junction_add_path, get(), points, Count, static_cast<uint8_t>(kind), &footprint, &path);
    }
    result set_line(uint8_t path, float s) { return call(cede_junction_set_line, get(), path, s); }
    result set_right_of_way(uint8_t first, uint8_t second) {
        return call(cede_junction_set_right_of_way, get(), first, second);
    }
    result set_priority(uint8_t first, uint8_t second, cede_priority priority) {
        return call(cede_junction_set_priority, get(), first, second, priority);
    }
    result set_control(uint8_t path, cede_control control) { return call(cede_junction_set_control, get(), path, control); }
    result add_speed_limit(uint8_t path, float from, float speed) {
        return call(cede_junction_add_speed_limit, get(), path, from, speed);
    }
    result set_pace(uint8_t path, float pace) { return call(cede_junction_set_pace, get(), path, pace); }
    result set_order(uint8_t path, uint16_t place) { return call(cede_junction_set_order, get(), path, place); }
    result build() { return call(cede_junction_build, get()); }
};

class approach : public object<cede_approach> {
public:
    result enter(const drive &drive, const junction &junction, uint8_t path) {
        return call(cede_approach_enter, get(), drive.get(), junction.get(), path);
    }
    result set_sight(uint64_t now_us, const cede_sight *sights, uint32_t count) {
        return call(cede_approach_set_sight, get(), now_us, sights, count);
    }
    [[nodiscard]] cede_status ready(uint64_t now_us, const cede_observation &seen, cede_readiness *readiness = nullptr) const {
        return cede_approach_ready(get(), now_us, &seen, readiness);
    }
    [[nodiscard]] cede_status decide(uint64_t now_us, const cede_observation &seen, cede_decision &decision) {
        return cede_approach_decide(get(), now_us, &seen, &decision);
    }
    [[nodiscard]] cede_status decide_up_to(uint64_t now_us, float most, const cede_observation &seen, cede_decision &decision) {
        return cede_approach_decide_up_to(get(), now_us, most, &seen, &decision);
    }
    result set_contract(const cede_contract &contract) { return call(cede_approach_set_contract, get(), &contract); }
    [[nodiscard]] cede_status set_policy(const policy &policy) { return cede_approach_set_policy(get(), policy.get()); }
    [[nodiscard]] cede_status goes_before(uint16_t number, uint8_t &first) const {
        return cede_approach_goes_before(get(), number, &first);
    }
    [[nodiscard]] cede_status forget(uint16_t number) { return cede_approach_forget(get(), number); }
};

} // namespace cede

#endif
