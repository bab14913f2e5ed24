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
  ego_max_speed k - speed_error k - speed_error k - (strongest k (ego_acceleration k) + strongest k (ego_emergency k)) * response k - strongest k (ego_go k) * period k - (ego_disturbance k + ego_disturbance k) / (1 - ego_gain k) * period k.

Definition hold (k : drivetrain) (least most : R) : R :=
  let x0 := Rmax 0 (Ropp least) in
  Ropp (ego_lag k * x0 / sqrt (1 + x0 / most)).

Definition departure_soon (k : drivetrain) (sensed first low1 high1 low2 high2 command : R) : departs :=
  let b := (at_most (at_most (start (sensed + speed_error k)) (Rmax high1 (strongest k command)) first) (Rmax high2 (strongest k command)) (response k - first)) in
  let f := hold k (Rmin low1 (weakest k command)) (Rmax (weakest k command) (weakest k (ego_go k))) in
  let s r q t := sinking (fading r (unlimited_driven k) ((ego_disturbance k + ego_disturbance k) / (1 - ego_gain k) * t)) q (unlimited_driven k) t f in
  let left := shortest_period k - first - (response k - first) in
  {| braking := at_most (at_most b (strongest k command) left) (strongest k command) (response k);
     most := at_most (at_most b (strongest k command) left) (Rmax (strongest k command) (strongest k (ego_go k))) (response k);
     least := s (s (s (s (start (sensed - speed_error k)) (Rmin low1 (weakest k command)) first) (Rmin low2 (weakest k command)) (response k - first)) (weakest k command) left) (Rmin (weakest k command) (weakest k (ego_go k))) (response k) |}.

Definition departure_late (k : drivetrain) (sensed first low1 high1 low2 high2 command : R) : departs :=
  let b0 := at_most (at_most (start (sensed + speed_error k)) (Rmax high1 (strongest k command)) first) (Rmax high2 (strongest k command)) (shortest_period k - first) in
  let f := hold k (Rmin low1 (weakest k command)) (Rmax (weakest k command) (weakest k (ego_go k))) in
  let s r q t := sinking (fading r (unlimited_driven k) ((ego_disturbance k + ego_disturbance k) / (1 - ego_gain k) * t)) q (unlimited_driven k) t f in
  {| braking := at_most (at_most b0 (Rmax high2 (strongest k command)) (response k - shortest_period k)) (strongest k command) (shortest_period k);
     most := at_most (at_most b0 (Rmax (Rmax high2 (strongest k command)) (strongest k (ego_go k))) (response k - shortest_period k)) (Rmax (strongest k command) (strongest k (ego_go k))) (shortest_period k);
     least := s (s (s (s (start (sensed - speed_error k)) (Rmin low1 (weakest k command)) first) (Rmin low2 (weakest k command)) (shortest_period k - first)) (Rmin (Rmin low2 (weakest k command)) (weakest k (ego_go k))) (response k - shortest_period k)) (Rmin (weakest k command) (weakest k (ego_go k))) (shortest_period k) |}.

Definition clearing_driven (k : drivetrain) (from : reach) (target : R) : R * R :=
  let f := fading from (unlimited_driven k) ((ego_disturbance k + ego_disturbance k) / (1 - ego_gain k) * (Rmax (target - distance from) 0 / unlimited_driven k)) in
  let u := until {| distance := distance f; speed := Rmax (speed f) 0 |} target (weakest k (ego_go k)) (unlimited_driven k) in
  (Rmax 0 (Ropp (speed f)) / weakest k (ego_go k) + fst u + shortest_period k + response k, snd u).

Definition rest_driven (k : drivetrain) (from : reach) (time : R) : R :=
  rest_of (at_most from (strongest k (ego_go k)) time) (weakest k (ego_braking k)).
