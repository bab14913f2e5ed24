(* The numbers of a contract, and what its constructor demands of them.
   Names are those of the Rust crate; symbols are those of docs/theorem.md. *)
Require Import Reals Lra.
Open Scope R_scope.

(* A distance travelled and the speed at its end (m, m/s). *)
Record reach := { distance : R; speed : R }.

(* D14 Departure: bounds on the ego until the first command of a plan is certainly in effect. *)
Record departs := { braking : reach; most : reach; least : reach }.

Record contract := {
  period : R;             (* Δt *)
  latency : R;            (* λ *)
  jitter : R;             (* j *)
  position_error : R;     (* ε_s *)
  speed_error : R;        (* ε_v *)
  slack : R;
  ego_max_speed : R;      (* v_max *)
  ego_acceleration : R;   (* a_max *)
  ego_go : R;             (* go *)
  ego_braking : R;        (* b *)
  other_max_speed : R;    (* v̂_max *)
  other_acceleration : R; (* â *)
  other_braking : R;      (* b̂ *)
  follower_reaction : R;  (* ρ *)
  follower_braking : R;   (* b̂_f *)
  precedence_braking : R  (* the rule's braking, with C7 *)
}.

(* (i), jitter: the least time from a call to the next one, and the time that a command may take from its turn on.
   The code computes these two in f32. *)
Definition shortest_period k := period k - 2 * jitter k.
Definition switching k := latency k + 4 * jitter k.

(* The speed below which neither limiter nor speed limit holds the ego back. *)
Definition unheld k :=
  ego_max_speed k - speed_error k - speed_error k - (ego_acceleration k + ego_braking k) * switching k
  - ego_go k * period k.

(* The hardest braking that a follower of the ego must expect of it. *)
Definition hardest k := Rmax (ego_braking k) (follower_braking k).

(* Ranges, A1 to A4 and A8. *)
Record valid (k : contract) : Prop := {
  period_pos : 0 < period k;
  latency_nonneg : 0 <= latency k;
  jitter_nonneg : 0 <= jitter k;
  position_error_nonneg : 0 <= position_error k;
  speed_error_nonneg : 0 <= speed_error k;
  slack_pos : 0 < slack k;
  ego_acceleration_pos : 0 < ego_acceleration k;
  ego_go_pos : 0 < ego_go k;
  ego_braking_pos : 0 < ego_braking k;
  other_acceleration_pos : 0 < other_acceleration k;
  other_max_speed_pos : 0 < other_max_speed k;
  other_braking_pos : 0 < other_braking k;
  follower_reaction_nonneg : 0 <= follower_reaction k;
  follower_braking_pos : 0 < follower_braking k;
  precedence_braking_pos : 0 < precedence_braking k;
  A1 : ego_braking k <= other_braking k;
  A2 : follower_braking k <= other_braking k;
  A3_latency : latency k + 6 * jitter k <= period k;
  A3_go : ego_go k <= ego_acceleration k;
  A4_acceleration : ego_acceleration k <= other_acceleration k;
  A4_braking : ego_acceleration k <= hardest k;
  A4_speed : ego_max_speed k <= other_max_speed k;
  unheld_enough : 1 / 100 <= unheld k
}.

(* A contract with a drivetrain and brakes that are late and not exact. Its latency may last several periods. *)
Record drivetrain := {
  exact :> contract;
  ego_emergency : R;   (* braking that is commanded while there is no plan *)
  ego_lag : R;         (* τ *)
  ego_gain : R;        (* γ *)
  ego_disturbance : R  (* d *)
}.

(* D14: the response T. The code computes it in f32. *)
Definition response (k : drivetrain) := switching k + ego_lag k.
