(* What every theorem rests on: check.sh compares it with axioms.txt. *)
Require Import Ego Shield Merge Pair Choice Limit Precedence Turns Order Controls Passage.
Print Assumptions verified_plans_keep_apart.
Print Assumptions at_most_one_comes_in_ahead.
Print Assumptions shielded_vehicles_keep_apart.
Print Assumptions two_shielded_vehicles.
Print Assumptions chosen_is_verified.
Print Assumptions kept_is_verified.
Print Assumptions may_go.
Print Assumptions keeps_limit.
Print Assumptions braking_first_matters.
Print Assumptions plan_is_followed.
Print Assumptions arrivals_exclude.
Print Assumptions arrivals_exclude_equals.
Print Assumptions surely_at_most_perhaps.
Print Assumptions never_two_turns.
Print Assumptions orders_agree.
Print Assumptions never_both_right_of_way.
Print Assumptions never_both_equals.
Print Assumptions never_both_sides.
Print Assumptions conditions_can_be_met.
Print Assumptions a_passage_can_be_verified.
Print Assumptions C6_is_needed.
Print Assumptions A9_is_needed.
Print Assumptions C2_acceleration_is_needed.
Print Assumptions slack_is_needed.
Print Assumptions A1_is_needed.
