(* The shield's bounds and margins, printed from the functions that the vehicle runs:
   cede verify lemmas --write rocq proofs/Shipped.v
   Do not edit: a test compares this file with what the code says now. *)
Require Import Reals.
Require Import Contract.
Open Scope R_scope.

Definition start (v : R) : reach :=
  {| distance := 0; speed := Rmax v 0 |}.

Definition at_most (from : reach) (acceleration time : R) : reach :=
  let x0 := Rmax (speed from + acceleration * time) 0 in
  {| distance := distance from + (speed from + x0) * time * (1 / 2); speed := x0 |}.

Definition at_least (from : reach) (acceleration cap time : R) : reach :=
  let x0 := Rmin (speed from + acceleration * time) (Rmax cap (speed from)) in
  {| distance := distance from + Rmax ((speed from + x0) * time * (1 / 2)) 0; speed := Rmax x0 0 |}.

Definition rushing (from : reach) (acceleration cap time : R) : reach :=
  let x0 := Rmax cap (speed from) in
  let x1 := (x0 - speed from) / acceleration in
  let x2 := Rmin time x1 in
  {| distance := distance from + (speed from + acceleration * x2 * (1 / 2)) * x2 + x0 * Rmax (time - x1) 0; speed := Rmin x0 (speed from + acceleration * time) |}.

Definition rest_of (from : reach) (braking : R) : R :=
  distance from + speed from * speed from / (braking + braking).

Definition until (from : reach) (target acceleration cap : R) : R * R :=
  let x0 := acceleration + acceleration in
  let x1 := Rmax (target - distance from) 0 in
  let x2 := Rmax cap (speed from) in
  let x3 := (x2 - speed from) * (x2 + speed from) / x0 in
  let x4 := sqrt (speed from * speed from + x0 * Rmin x1 x3) in
  (Rmax (x4 - speed from) 0 / acceleration + Rmax (x1 - x3) 0 / x2, x4).

Definition unlimited (k : contract) : R :=
  ego_max_speed k - speed_error k - speed_error k - (ego_acceleration k + ego_braking k) * switching k - ego_go k * period k.

Definition departure (k : contract) (sensed previous_least previous_most command : R) : departs :=
  let x0 := Rmax (sensed + speed_error k) 0 in
  let x1 := Rmax (x0 + Rmax previous_most command * switching k) 0 in
  let x2 := shortest_period k - switching k in
  let x3 := command * x2 in
  let x4 := Rmax (x1 + x3) 0 in
  let x5 := 0 + (x0 + x1) * switching k * (1 / 2) + (x1 + x4) * x2 * (1 / 2) in
  let x6 := Rmax (x4 + command * switching k) 0 in
  let x7 := Rmax (x4 + Rmax command (ego_go k) * switching k) 0 in
  let x8 := Rmax (sensed - speed_error k) 0 in
  let x9 := ego_max_speed k - speed_error k - speed_error k - (ego_acceleration k + ego_braking k) * switching k - ego_go k * period k in
  let x10 := Rmin (x8 + Rmin previous_least command * switching k) (Rmax x9 x8) in
  let x11 := Rmax x10 0 in
  let x12 := Rmin (x11 + x3) (Rmax x9 x11) in
  let x13 := Rmax x12 0 in
  let x14 := Rmin (x13 + Rmin command (ego_go k) * switching k) (Rmax x9 x13) in
  {| braking := {| distance := x5 + (x4 + x6) * switching k * (1 / 2); speed := x6 |};
     most := {| distance := x5 + (x4 + x7) * switching k * (1 / 2); speed := x7 |};
     least := {| distance := 0 + Rmax ((x8 + x10) * switching k * (1 / 2)) 0 + Rmax ((x11 + x12) * x2 * (1 / 2)) 0 + Rmax ((x13 + x14) * switching k * (1 / 2)) 0; speed := Rmax x14 0 |} |}.

Definition clearing (k : contract) (from : reach) (target : R) : R * R :=
  let x0 := ego_go k + ego_go k in
  let x1 := Rmax (target - distance from) 0 in
  let x2 := Rmax (ego_max_speed k - speed_error k - speed_error k - (ego_acceleration k + ego_braking k) * switching k - ego_go k * period k) (speed from) in
  let x3 := (x2 - speed from) * (x2 + speed from) / x0 in
  let x4 := sqrt (speed from * speed from + x0 * Rmin x1 x3) in
  (Rmax (x4 - speed from) 0 / ego_go k + Rmax (x1 - x3) 0 / x2 + shortest_period k + switching k, x4).

Definition rest (k : contract) (from : reach) (time : R) : R :=
  let x0 := Rmax (speed from + ego_go k * time) 0 in
  distance from + (speed from + x0) * time * (1 / 2) + x0 * x0 / (ego_braking k + ego_braking k).

Definition stops_short (k : contract) (limit rests : R) : R :=
  limit - rests - slack k.

Definition rush (k : contract) (v time : R) : reach :=
  let x0 := Rmax v 0 in
  let x1 := Rmax (other_max_speed k) x0 in
  let x2 := (x1 - x0) / other_acceleration k in
  let x3 := Rmin time x2 in
  {| distance := 0 + (x0 + other_acceleration k * x3 * (1 / 2)) * x3 + x1 * Rmax (time - x2) 0; speed := Rmin x1 (x0 + other_acceleration k * time) |}.

Definition dawdle (k : contract) (v time : R) : reach :=
  let x0 := Rmax v 0 in
  let x1 := Rmin (x0 + Ropp (other_braking k) * time) (Rmax 0 x0) in
  {| distance := 0 + Rmax ((x0 + x1) * time * (1 / 2)) 0; speed := Rmax x1 0 |}.

Definition clears_before (k : contract) (away : R) (from : reach) : R :=
  away - distance from - slack k.

Definition safe_gap (k : contract) (v ego_v : R) : R :=
  let x0 := Rmax v 0 in
  let x1 := Rmax (other_max_speed k) x0 in
  let x2 := (x1 - x0) / other_acceleration k in
  let x3 := Rmin (follower_reaction k) x2 in
  let x4 := Rmin x1 (x0 + other_acceleration k * follower_reaction k) in
  let x5 := Rmax ego_v 0 in
  let x6 := Rmax (ego_braking k) (follower_braking k) in
  Rmax (0 + (x0 + other_acceleration k * x3 * (1 / 2)) * x3 + x1 * Rmax (follower_reaction k - x2) 0 + x4 * x4 / (follower_braking k + follower_braking k) - (0 + x5 * x5 / (x6 + x6))) 0.

Definition enters_ahead (k : contract) (gap : R) (from : reach) (needed : R) : R :=
  gap - distance from - needed - slack k.

Definition earliest_rest (k : contract) (v : R) : R :=
  let x0 := Rmax v 0 in
  0 + x0 * x0 / (other_braking k + other_braking k).

Definition most_command (k : contract) (sensed in_effect : R) : R :=
  let x0 := ego_max_speed k - sensed - speed_error k in
  Rmin (Rmax 0 (Rmin ((x0 - Rmax 0 in_effect * switching k) / period k) (x0 / (period k + switching k)))) (ego_acceleration k).

Definition strongest (k : drivetrain) (command : R) : R :=
  command + (ego_gain k * Rmax command (Ropp command) + ego_disturbance k).

Definition weakest (k : drivetrain) (command : R) : R :=
  command - (ego_gain k * Rmax command (Ropp command) + ego_disturbance k).

Definition fading (from : reach) (cap loss : R) : reach :=
  {| distance := distance from; speed := Rmin (speed from) (Rmax cap (speed from - loss)) |}.

Definition sinking (from : reach) (acceleration cap time floor : R) : reach :=
  let x0 := Rmin (speed from + acceleration * time) (Rmax cap (speed from)) in
  {| distance := distance from + Rmax ((speed from + x0) * time * (1 / 2)) 0; speed := Rmax x0 floor |}.

Definition unlimited_driven (k : drivetrain) : R :=
  ego_max_speed k - speed_error k - speed_error k - (ego_acceleration k + (ego_gain k * Rmax (ego_acceleration k) (Ropp (ego_acceleration k)) + ego_disturbance k) + (ego_emergency k + (ego_gain k * Rmax (ego_emergency k) (Ropp (ego_emergency k)) + ego_disturbance k))) * response k - (ego_go k + (ego_gain k * Rmax (ego_go k) (Ropp (ego_go k)) + ego_disturbance k)) * period k - (ego_disturbance k + ego_disturbance k) / (1 - ego_gain k) * period k.

Definition hold (k : drivetrain) (least most : R) : R :=
  let x0 := Rmax 0 (Ropp least) in
  Ropp (ego_lag k * x0 / sqrt (1 + x0 / most)).

Definition departure_soon (k : drivetrain) (sensed lowest highest command : R) : departs :=
  let x0 := Rmax (sensed + speed_error k) 0 in
  let x1 := ego_gain k * Rmax command (Ropp command) + ego_disturbance k in
  let x2 := command + x1 in
  let x3 := Rmax (x0 + Rmax highest x2 * response k) 0 in
  let x4 := shortest_period k - response k in
  let x5 := Rmax (x3 + x2 * x4) 0 in
  let x6 := 0 + (x0 + x3) * response k * (1 / 2) + (x3 + x5) * x4 * (1 / 2) in
  let x7 := Rmax (x5 + x2 * response k) 0 in
  let x8 := ego_gain k * Rmax (ego_go k) (Ropp (ego_go k)) + ego_disturbance k in
  let x9 := ego_go k + x8 in
  let x10 := Rmax (x5 + Rmax x2 x9 * response k) 0 in
  let x11 := Rmax (sensed - speed_error k) 0 in
  let x12 := (ego_disturbance k + ego_disturbance k) / (1 - ego_gain k) in
  let x13 := ego_max_speed k - speed_error k - speed_error k - (ego_acceleration k + (ego_gain k * Rmax (ego_acceleration k) (Ropp (ego_acceleration k)) + ego_disturbance k) + (ego_emergency k + (ego_gain k * Rmax (ego_emergency k) (Ropp (ego_emergency k)) + ego_disturbance k))) * response k - x9 * period k - x12 * period k in
  let x14 := x12 * response k in
  let x15 := Rmin x11 (Rmax x13 (x11 - x14)) in
  let x16 := command - x1 in
  let x17 := Rmin lowest x16 in
  let x18 := Rmin (x15 + x17 * response k) (Rmax x13 x15) in
  let x19 := Rmax 0 (Ropp x17) in
  let x20 := ego_go k - x8 in
  let x21 := Ropp (ego_lag k * x19 / sqrt (1 + x19 / Rmax x16 x20)) in
  let x22 := Rmax x18 x21 in
  let x23 := Rmin x22 (Rmax x13 (x22 - x12 * x4)) in
  let x24 := Rmin (x23 + x16 * x4) (Rmax x13 x23) in
  let x25 := Rmax x24 x21 in
  let x26 := Rmin x25 (Rmax x13 (x25 - x14)) in
  let x27 := Rmin (x26 + Rmin x16 x20 * response k) (Rmax x13 x26) in
  {| braking := {| distance := x6 + (x5 + x7) * response k * (1 / 2); speed := x7 |};
     most := {| distance := x6 + (x5 + x10) * response k * (1 / 2); speed := x10 |};
     least := {| distance := 0 + Rmax ((x15 + x18) * response k * (1 / 2)) 0 + Rmax ((x23 + x24) * x4 * (1 / 2)) 0 + Rmax ((x26 + x27) * response k * (1 / 2)) 0; speed := Rmax x27 x21 |} |}.

Definition clearing_driven (k : drivetrain) (from : reach) (target : R) : R * R :=
  let x0 := ego_gain k * Rmax (ego_go k) (Ropp (ego_go k)) + ego_disturbance k in
  let x1 := (ego_disturbance k + ego_disturbance k) / (1 - ego_gain k) in
  let x2 := ego_max_speed k - speed_error k - speed_error k - (ego_acceleration k + (ego_gain k * Rmax (ego_acceleration k) (Ropp (ego_acceleration k)) + ego_disturbance k) + (ego_emergency k + (ego_gain k * Rmax (ego_emergency k) (Ropp (ego_emergency k)) + ego_disturbance k))) * response k - (ego_go k + x0) * period k - x1 * period k in
  let x3 := Rmax (target - distance from) 0 in
  let x4 := Rmin (speed from) (Rmax x2 (speed from - x1 * (x3 / x2))) in
  let x5 := ego_go k - x0 in
  let x6 := Rmax x4 0 in
  let x7 := x5 + x5 in
  let x8 := Rmax x2 x6 in
  let x9 := (x8 - x6) * (x8 + x6) / x7 in
  let x10 := sqrt (x6 * x6 + x7 * Rmin x3 x9) in
  (Rmax 0 (Ropp x4) / x5 + (Rmax (x10 - x6) 0 / x5 + Rmax (x3 - x9) 0 / x8) + shortest_period k + response k, x10).

Definition rest_driven (k : drivetrain) (from : reach) (time : R) : R :=
  let x0 := Rmax (speed from + (ego_go k + (ego_gain k * Rmax (ego_go k) (Ropp (ego_go k)) + ego_disturbance k)) * time) 0 in
  let x1 := ego_braking k - (ego_gain k * Rmax (ego_braking k) (Ropp (ego_braking k)) + ego_disturbance k) in
  distance from + (speed from + x0) * time * (1 / 2) + x0 * x0 / (x1 + x1).

Definition safe_gap_driven (k : drivetrain) (v ego_v : R) : R :=
  let x0 := Rmax v 0 in
  let x1 := Rmax (other_max_speed k) x0 in
  let x2 := (x1 - x0) / other_acceleration k in
  let x3 := Rmin (follower_reaction k) x2 in
  let x4 := Rmin x1 (x0 + other_acceleration k * follower_reaction k) in
  let x5 := Rmax ego_v 0 in
  let x6 := Rmax (ego_braking k + (ego_gain k * Rmax (ego_braking k) (Ropp (ego_braking k)) + ego_disturbance k)) (follower_braking k) in
  Rmax (0 + (x0 + other_acceleration k * x3 * (1 / 2)) * x3 + x1 * Rmax (follower_reaction k - x2) 0 + x4 * x4 / (follower_braking k + follower_braking k) - (0 + x5 * x5 / (x6 + x6))) 0.

Definition departure_late (k : drivetrain) (sensed lowest highest command : R) : departs :=
  let x0 := Rmax (sensed + speed_error k) 0 in
  let x1 := ego_gain k * Rmax command (Ropp command) + ego_disturbance k in
  let x2 := command + x1 in
  let x3 := Rmax highest x2 in
  let x4 := Rmax (x0 + x3 * shortest_period k) 0 in
  let x5 := 0 + (x0 + x4) * shortest_period k * (1 / 2) in
  let x6 := Rmax (x4 + x3 * (response k - shortest_period k)) 0 in
  let x7 := Rmax (x6 + x2 * shortest_period k) 0 in
  let x8 := ego_gain k * Rmax (ego_go k) (Ropp (ego_go k)) + ego_disturbance k in
  let x9 := ego_go k + x8 in
  let x10 := Rmax (x4 + Rmax x3 x9 * (response k - shortest_period k)) 0 in
  let x11 := Rmax (x10 + Rmax x2 x9 * shortest_period k) 0 in
  let x12 := Rmax (sensed - speed_error k) 0 in
  let x13 := (ego_disturbance k + ego_disturbance k) / (1 - ego_gain k) in
  let x14 := ego_max_speed k - speed_error k - speed_error k - (ego_acceleration k + (ego_gain k * Rmax (ego_acceleration k) (Ropp (ego_acceleration k)) + ego_disturbance k) + (ego_emergency k + (ego_gain k * Rmax (ego_emergency k) (Ropp (ego_emergency k)) + ego_disturbance k))) * response k - x9 * period k - x13 * period k in
  let x15 := x13 * shortest_period k in
  let x16 := Rmin x12 (Rmax x14 (x12 - x15)) in
  let x17 := command - x1 in
  let x18 := Rmin lowest x17 in
  let x19 := Rmin (x16 + x18 * shortest_period k) (Rmax x14 x16) in
  let x20 := Rmax 0 (Ropp x18) in
  let x21 := ego_go k - x8 in
  let x22 := Ropp (ego_lag k * x20 / sqrt (1 + x20 / Rmax x17 x21)) in
  let x23 := Rmax x19 x22 in
  let x24 := Rmin x23 (Rmax x14 (x23 - x13 * (response k - shortest_period k))) in
  let x25 := Rmin (x24 + Rmin x18 x21 * (response k - shortest_period k)) (Rmax x14 x24) in
  let x26 := Rmax x25 x22 in
  let x27 := Rmin x26 (Rmax x14 (x26 - x15)) in
  let x28 := Rmin (x27 + Rmin x17 x21 * shortest_period k) (Rmax x14 x27) in
  {| braking := {| distance := x5 + (x4 + x6) * (response k - shortest_period k) * (1 / 2) + (x6 + x7) * shortest_period k * (1 / 2); speed := x7 |};
     most := {| distance := x5 + (x4 + x10) * (response k - shortest_period k) * (1 / 2) + (x10 + x11) * shortest_period k * (1 / 2); speed := x11 |};
     least := {| distance := 0 + Rmax ((x16 + x19) * shortest_period k * (1 / 2)) 0 + Rmax ((x24 + x25) * (response k - shortest_period k) * (1 / 2)) 0 + Rmax ((x27 + x28) * shortest_period k * (1 / 2)) 0; speed := Rmax x28 x22 |} |}.
