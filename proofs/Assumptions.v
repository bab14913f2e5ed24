(* What every theorem rests on: check.sh compares it with axioms.txt. *)
Require Import Shield Merge Controls.
Print Assumptions verified_plans_keep_apart.
Print Assumptions at_most_one_comes_in_ahead.
Print Assumptions conditions_can_be_met.
Print Assumptions C6_is_needed.
Print Assumptions A9_is_needed.
Print Assumptions C2_acceleration_is_needed.
Print Assumptions slack_is_needed.
Print Assumptions A1_is_needed.
