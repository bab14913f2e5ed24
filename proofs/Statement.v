(* What is guaranteed, to whom, under which conditions: docs/theorem.md in Rocq.
   The numbers of D-, A- and C-conditions are those of docs/theorem.md and docs/manual.md.
   Bounds and margins are those of Shipped.v, which is printed from the code that flies. *)
Require Import Reals List.
Require Import Contract Shipped Motion Reach.
Open Scope R_scope.

(** * The road *)

(* D3 Zone: a box of places of ego and other, and a band of the lead. D4: a zone is a lane or a crossing. *)
Record zone := {
  s_in : R; s_out : R;           (* the ego's side of the box *)
  t_in : R; t_out : R;           (* the other's side *)
  lead_from : R; lead_to : R;    (* δ₋, δ₊ *)
  lane : bool
}.

(* Ego at s and other at t are both inside the zone. *)
Definition inside (z : zone) (s t : R) :=
  s_in z < s < s_out z /\ t_in z < t < t_out z /\ lead_from z < s - t < lead_to z.

(* D2, D3, (iv): every pair of places at which the footprints overlap is inside one of the zones. *)
Definition cover (zones : list zone) (occupied : R -> R -> Prop) :=
  forall s t, occupied s t -> exists z, In z zones /\ inside z s t.

(** * The ego *)

(* A13: call number i is at time tau i, on a grid of periods up to the jitter. *)
Definition on_grid (k : contract) (tau : nat -> R) :=
  exists start, forall i,
    start + INR i * period k - jitter k <= tau i <= start + INR i * period k + jitter k.

(* C4, C5: command c (S i) is given at call S i; until it takes effect, within the latency, the acceleration is anything
   from the command before it to this one. A limiter may hold the ego at a speed of [unheld] or more. Command c 0 is the
   one before the first call. *)
Record obeys (k : contract) (v : R -> R) (tau c : nat -> R) : Prop := {
  commanded : forall i, - ego_braking k <= c i <= ego_acceleration k;
  switches_up : forall i,
    speeds_up_at_most v (Rmax (c i) (c (S i))) (tau (S i)) (tau (S i) + latency k);
  stays_up : forall i,
    speeds_up_at_most v (c (S i)) (tau (S i) + latency k) (tau (S (S i)));
  switches_down : forall i,
    speeds_up_at_least v (Rmin (c i) (c (S i))) (unheld k) (tau (S i)) (tau (S i) + latency k);
  stays_down : forall i,
    speeds_up_at_least v (c (S i)) (unheld k) (tau (S i) + latency k) (tau (S (S i)))
}.

(* What the shield knows of the ego at a call: place and speed as sensed, and a place that it has certainly reached. *)
Record own := { own_s : R; own_v : R; own_least : R }.

(* C3 for the ego. *)
Definition own_holds (k : contract) (o : own) (s v : R) :=
  (own_s o - position_error k <= s <= own_s o + position_error k) /\
  (own_v o - speed_error k <= v <= own_v o + speed_error k) /\
  own_least o <= s.

(** * The others *)

(* C2: the other accelerates at most at â, up to v̂_max or the speed that it has, and brakes at most at b̂. *)
Record keeps_contract (k : contract) (w : R -> R) (from : R) : Prop := {
  rushes : forall u, rushes_at_most w (other_acceleration k) (other_max_speed k) from u;
  brakes : forall u, brakes_at_most w (other_braking k) from u
}.

(* D5 Bounds on an other's place and speed. *)
Record bounds := { t_least : R; t_most : R; w_least : R; w_most : R }.

Definition hold (b : bounds) (t w : R) := t_least b <= t <= t_most b /\ w_least b <= w <= w_most b.

(* Bounds::sensed *)
Definition sensed (k : contract) (place v : R) : bounds := {|
  t_least := place - position_error k; t_most := place + position_error k;
  w_least := speed (start (v - speed_error k)); w_most := speed (start (v + speed_error k)) |}.

(* Bounds::after *)
Definition after (k : contract) (b : bounds) (time : R) : bounds := {|
  t_least := t_least b + distance (dawdle k (w_least b) time);
  t_most := t_most b + distance (rush k (w_most b) time);
  w_least := speed (dawdle k (w_least b) time); w_most := speed (rush k (w_most b) time) |}.

(* Nobody moves backwards: what an other has passed, it has passed for ever. *)
Definition passed (b former : bounds) : bounds := {|
  t_least := Rmax (t_least former) (t_least b); t_most := t_most b; w_least := w_least b; w_most := w_most b |}.

(* D18: within two bounds at once. *)
Definition common (b b' : bounds) : bounds := {|
  t_least := Rmax (t_least b) (t_least b'); t_most := Rmin (t_most b) (t_most b');
  w_least := Rmax (w_least b) (w_least b'); w_most := Rmin (w_most b) (w_most b') |}.

(* What the shield may know of an other at a time: what it sees (C3), what becomes of that while the other coasts, and
   what it remembers; and what it is told of who is out of sight (A14), alone or together with what is known of it by the edge
   of before, or from what is seen once it has emerged. *)
Inductive known (k : contract) (t w : R -> R) (from : R) : R -> bounds -> Prop :=
  | seen u place v :
      from <= u -> place - position_error k <= t u <= place + position_error k ->
      v - speed_error k <= w u <= v + speed_error k -> known k t w from u (sensed k place v)
  | coasts u u' b : known k t w from u b -> u <= u' -> known k t w from u' (after k b (u' - u))
  | remembered u u' b former :
      known k t w from u former -> known k t w from u' b -> u <= u' -> known k t w from u' (passed b former)
  | told u place least speed_ :
      from <= u -> least <= t u <= place -> w u <= speed_ ->
      known k t w from u {| t_least := least; t_most := place; w_least := 0; w_most := speed_ |}
  | both u b b' : known k t w from u b -> known k t w from u b' -> known k t w from u (common b b').

(* The gap from the other to an ego ahead of it in a lane is safe: D10. *)
Definition safe (k : contract) (z : zone) (s v t w : R) := safe_gap k w v <= s - t - lead_to z.

(* C6: once the ego is in the lane with a safe gap, the other keeps its distance. Whenever it is nearer than safe, there is
   a time at which the gap was safe and after which it has braked, its reaction time later, at b̂_f or harder. *)
Definition keeps_distance (k : contract) (z : zone) (s v t w : R -> R) (from : R) :=
  forall T u, from <= T -> T <= u -> s_in z <= s T -> safe k z (s T) (v T) (t T) (w T) ->
    s u < s_out z -> t u < t_out z ->
    exists T', T <= T' <= u /\ safe k z (s T') (v T') (t T') (w T') /\
      speeds_up_at_most w (- follower_braking k) (T' + follower_reaction k) u.

(** * Plans *)

(* D11: where the ego is at rest if it carries out the plan: the command in the departure, n periods of go, then brakes. *)
Definition rests (k : contract) (d : departs) (n : nat) :=
  match n with
  | O => rest_of (braking d) (ego_braking k)
  | S _ => rest k (most d) (INR n * period k)
  end.

(* D7: it rests before a limit. *)
Definition stops (k : contract) (d : departs) (n : nat) (limit : R) := 0 <= stops_short k limit (rests k d n).

(* D8: having gone for n periods it has certainly gone as far as the target. *)
Definition in_time (k : contract) (d : departs) (n : nat) (target : R) :=
  fst (clearing k (least d) target) <= shortest_period k + INR n * period k.

(* D7 Limit: s_in, as a distance from where the ego seems to be. *)
Definition stop_limit (k : contract) (z : zone) (o : own) := s_in z - own_s o - position_error k.

(* D7 Limit, behind in a lane. *)
Definition behind (k : contract) (z : zone) (o : own) (b : bounds) :=
  let gap := lead_from z - (own_s o + position_error k - t_least b) in
  if Rlt_dec gap 0 then gap else gap + earliest_rest k (w_least b).

(* D8 Passage at a crossing. *)
Definition passes (k : contract) (z : zone) (o : own) (b : bounds) (d : departs) (n : nat) :=
  let target := s_out z - own_s o + 3 * position_error k in
  let clears := fst (clearing k (least d) target) in
  in_time k d n target /\ 0 <= clears_before k (t_in z - t_most b) (rush k (w_most b) clears).

(* D8 Passage ahead into a lane. *)
Definition gap_ahead (z : zone) (o : own) (b : bounds) := Rmax (s_in z) (own_least o) - t_most b - lead_to z.

Definition enters (k : contract) (z : zone) (o : own) (b : bounds) (d : departs) (n : nat) :=
  let target := s_in z - own_s o + 3 * position_error k in
  let (clears, v) := clearing k (least d) target in
  let rushed := rush k (w_most b) clears in
  in_time k d n target /\ 0 <= enters_ahead k (gap_ahead z o b) rushed (safe_gap k (speed rushed) v).

(* D12 for one hazard. Of the limits and passages of a lane the code tries only those that D7 and D8 name; the theorem holds
   for whichever is met. A closed zone (D15) is met by its limit. *)
Definition verified (k : contract) (z : zone) (o : own) (b : bounds) (d : departs) (n : nat) :=
  stops k d n (stop_limit k z o) \/
  if lane z then stops k d n (behind k z o b) \/ enters k z o b d n else passes k z o b d n.

(** * The shield at work *)

(* At each call: the ego as it is known, the bounds on the acceleration in effect, and how many periods of go follow the
   command. *)
Record log := {
  ego_at : nat -> own;
  previous_least : nat -> R; previous_most : nat -> R;
  goes : nat -> nat
}.

(* What is logged is true, at every call S i, and nothing harder than a_max is taken to be in effect. At a call that sees
   nothing anything true may stand there: nothing is verified then. *)
Definition true_log (k : contract) (l : log) (s v : R -> R) (tau c : nat -> R) :=
  forall i, own_holds k (ego_at l (S i)) (s (tau (S i))) (v (tau (S i))) /\
    previous_least l (S i) <= c i <= previous_most l (S i) /\ previous_most l (S i) <= ego_acceleration k.

(* D14 at call i. *)
Definition departs_at (k : contract) (l : log) (c : nat -> R) (i : nat) : departs :=
  departure k (own_v (ego_at l i)) (previous_least l i) (previous_most l i) (c i).

(* D11: at call i the ego goes as hard as its speed limit lets it, or harder if it does not see its own speed. *)
Definition goes_on (k : contract) (l : log) (c : nat -> R) (i : nat) :=
  Rmin (ego_go k) (most_command k (own_v (ego_at l i)) (previous_most l i)) <= c i <= ego_go k.

(* At call S i the plan in force at call i is carried on: its next command is given, and it is one command shorter. *)
Definition carries_on (k : contract) (l : log) (c : nat -> R) (i : nat) :=
  match goes l i with
  | O => c (S i) = - ego_braking k /\ goes l (S i) = O
  | S n => goes_on k l c (S i) /\ goes l (S i) = n
  end.

(* Something was checked of the plan in force at call i: at a call from first up to i, since which it is carried on. *)
Definition in_force (k : contract) (l : log) (c : nat -> R) (first : nat) (checked : nat -> Prop) (i : nat) :=
  exists i0, (first <= i0 <= i)%nat /\ checked i0 /\ forall j, (i0 <= j < i)%nat -> carries_on k l c j.

Section ZoneOfAnOther.
Variables (k : contract) (l : log) (c : nat -> R) (b : nat -> bounds) (z : zone) (claimed : nat -> Prop) (since : nat).

(* The plan of call i is verified against the zone: it was new then, or the other or its path was (D16). *)
Definition verified_at (i : nat) := verified k z (ego_at l i) (b i) (departs_at k l c i) (goes l i).
Definition enters_at (i : nat) :=
  lane z = true /\ enters k z (ego_at l i) (b i) (departs_at k l c i) (goes l i).

(* D6 Over. *)
Definition over (i : nat) := s_out z <= own_least (ego_at l i) \/ t_out z <= t_least (b i).

(* D9 Ahead: certainly in the lane, and leading by half the band or more, wherever the other may be. *)
Definition is_ahead (i : nat) :=
  s_in z <= own_least (ego_at l i) /\
  (lead_from z + lead_to z) / 2 <= own_s (ego_at l i) - (t_most (b i) - position_error k).

(* D9 Settled at call i: the plan in force entered with the safe gap; or the gap is safe now; or the other is new. *)
Definition settles (i : nat) :=
  lane z = true /\ is_ahead i /\
  ((exists i', i = S i' /\ in_force k l c since enters_at i') \/
   safe_gap k (w_most (b i)) (Rmax (own_v (ego_at l i) - speed_error k) 0) <= gap_ahead z (ego_at l i) (b i) \/
   i = since).
Definition settled (i : nat) := exists i0, (since <= i0 <= i)%nat /\ settles i0.

(* D13 Opened at call i: the ego has precedence, and the other can still stop. To have precedence in a lane, the ego must
   have arrived at its line as well. *)
Definition opened_at (i : nat) := claimed i /\
  rest_of {| distance := t_most (b i); speed := w_most (b i) |} (precedence_braking k) <= t_in z.

(* At call i nothing is to be feared of the zone: it is over or settled, the plan in force was verified against it, or it
   counts on the ego's precedence. *)
Definition judged (i : nat) :=
  over i \/ settled i \/ in_force k l c since verified_at i \/ in_force k l c since opened_at i.
End ZoneOfAnOther.

(** * The theorem *)

(* An other: its motion, its path, the call at which it is first seen, and the shield's view of it on each of its
   candidate paths. *)
Record other (path : Type) := {
  place : R -> R; rate : R -> R;
  on : path;
  since : nat;
  candidates : nat -> path -> Prop;
  view : path -> nat -> bounds;
  claims : path -> zone -> nat -> Prop   (* at a call the ego has precedence over it in the zone *)
}.
Arguments place {path}. Arguments rate {path}. Arguments on {path}. Arguments since {path}.
Arguments candidates {path}. Arguments view {path}. Arguments claims {path}.

(* C7: an other that can still stop before a zone in which the ego has precedence stays out of it while the plan in force
   counts on it; or, in a lane, behind the ego. *)
Definition gives_way (k : contract) (z : zone) (s : R -> R) (tau : nat -> R) (l : log) (c : nat -> R) (t w : R -> R)
    (claimed : nat -> Prop) (since : nat) :=
  forall i0 i, (since <= i0 <= i)%nat -> claimed i0 ->
    rest_of {| distance := t (tau i0); speed := w (tau i0) |} (precedence_braking k) <= t_in z ->
    (forall j, (i0 <= j < i)%nat -> carries_on k l c j) ->
    forall u, tau i0 <= u <= tau (S i) -> t u <= t_in z \/ (lane z = true /\ lead_to z <= s u - t u).

(* C2, C3, C6, C7, A9, A11 for an other. *)
Record keeps_all (k : contract) (path : Type) (zones : path -> list zone) (s v : R -> R) (tau c : nat -> R)
    (l : log) (o : other path) : Prop := {
  moves_forwards : motion (place o) (rate o);
  C2 : keeps_contract k (rate o) (tau (since o));
  C3 : forall i, (since o <= i)%nat -> known k (place o) (rate o) (tau (since o)) (tau i) (view o (on o) i);
  C6 : forall z, In z (zones (on o)) -> lane z = true ->
    keeps_distance k z s v (place o) (rate o) (tau (since o));
  C7 : forall z, In z (zones (on o)) ->
    gives_way k z s tau l c (place o) (rate o) (claims o (on o) z) (since o);
  A9 : forall z, In z (zones (on o)) -> lane z = true -> is_ahead k l (view o (on o)) z (since o) ->
    safe k z (s (tau (since o))) (v (tau (since o))) (place o (tau (since o))) (rate o (tau (since o)));
  A11 : forall i, (since o <= i)%nat -> candidates o i (on o);
  starts : (1 <= since o)%nat
}.

(* What may be demanded of an other: arguments as of [keeps_all]. *)
Definition conducts := forall (k : contract) (path : Type),
  (path -> list zone) -> (R -> R) -> (R -> R) -> (nat -> R) -> (nat -> R) -> log -> other path -> Prop.

(* The conditions: a valid contract, zones that cover, an ego that obeys what it is commanded, a true log, others that keep
   the contract, and a shield that judges every zone of every candidate path of every other at every call.
   What is demanded of contract and others is an argument, so that Controls.v can leave something out. *)
Definition Conditions (contracts : contract -> Prop) (conduct : conducts)
    (k : contract) (path : Type) (zones : path -> list zone) (occupied : path -> R -> R -> Prop)
    (s v : R -> R) (tau c : nat -> R) (l : log) (others : other path -> Prop) :=
  contracts k /\
  (forall p, cover (zones p) (occupied p)) /\
  motion s v /\ on_grid k tau /\ obeys k v tau c /\ true_log k l s v tau c /\
  (forall o, others o -> conduct k path zones s v tau c l o) /\
  (forall o i p z, others o -> (since o <= i)%nat -> candidates o i p -> In z (zones p) ->
    judged k l c (view o p) z (claims o p z) (since o) i).

(* Then the ego never overlaps an other, at any time from the first call at which it is seen. *)
Definition Guarantee (contracts : contract -> Prop) (conduct : conducts) :=
  forall k path zones occupied s v tau c l others,
  Conditions contracts conduct k path zones occupied s v tau c l others ->
  forall o u, others o -> tau (since o) <= u -> ~ occupied (on o) (s u) (place o u).

(* Theorem 1. *)
Definition Theorem1 := Guarantee valid keeps_all.

(* Two vehicles see mirrored zones of each other. *)
Definition mirrored (z y : zone) :=
  s_in y = t_in z /\ s_out y = t_out z /\ t_in y = s_in z /\ t_out y = s_out z /\
  lead_from y = - lead_to z /\ lead_to y = - lead_from z.

(* The corner of the box is in the band. *)
Definition corner_in_band (z : zone) := lead_from z <= s_in z - t_in z <= lead_to z.

(* A shielded vehicle that was before the lane when its plan was verified is at its beginning now, at time x, and the plan
   in force enters the lane ahead of the other. *)
Definition comes_in_ahead (k : contract) (z : zone) (s v t w : R -> R) (x : R) :=
  exists (tau c : nat -> R) (l : log) (b : nat -> bounds) (i0 i : nat),
    on_grid k tau /\ obeys k v tau c /\ true_log k l s v tau c /\
    keeps_contract k w (tau i0) /\ (forall j, (i0 <= j)%nat -> known k t w (tau i0) (tau j) (b j)) /\
    (1 <= i0 <= i)%nat /\ (forall j, (i0 <= j < i)%nat -> carries_on k l c j) /\ enters_at k l c b z i0 /\
    s (tau i0) < s_in z /\ tau i0 <= x <= tau (S i) /\ s x = s_in z /\ (forall u, u < x -> s u < s_in z).

(* Theorem 2. Of two shielded vehicles that enter a lane, at most one enters as the one ahead, in whatever order. *)
Definition Theorem2 := forall k z y s v t w x1 x2,
  valid k -> mirrored z y -> corner_in_band z -> motion s v -> motion t w ->
  comes_in_ahead k z s v t w x1 -> ~ comes_in_ahead k y t w s v x2.

(* A shielded vehicle as another one sees it: it keeps its own contract, and judges the zone at every call. *)
Record shielded (k : contract) (z : zone) (s v t w : R -> R) (from : R) : Prop := {
  exists_shield : exists (tau c : nat -> R) (l : log) (b : nat -> bounds) (since : nat),
    from = tau since /\ (1 <= since)%nat /\
    on_grid k tau /\ obeys k v tau c /\ true_log k l s v tau c /\
    keeps_contract k w (tau since) /\ (forall j, (since <= j)%nat -> known k t w (tau since) (tau j) (b j)) /\
    forall i, (since <= i)%nat -> judged k l c b z (fun _ => False) since i
}.

(* C6 is a consequence: two shielded vehicles that watch each other since before either was in the lane never are in it
   together, whoever comes first. Neither C6 nor A9 is assumed; nor is precedence used. *)
Definition Theorem2_together := forall k z y s v t w from from',
  valid k -> lane z = true -> lane y = true -> mirrored z y ->
  lead_from z < s_in z - t_in z < lead_to z ->
  motion s v -> motion t w ->
  shielded k z s v t w from -> shielded k y t w s v from' ->
  s (Rmax from from') < s_in z -> t (Rmax from from') < t_in z ->
  forall u, Rmax from from' <= u -> ~ inside z (s u) (t u).

(* So two shielded vehicles keep apart: at crossings each of them sees to it, whatever the other does. *)
Definition Theorem2_apart := forall k zones occupied s v t w from from',
  valid k -> cover zones occupied -> motion s v -> motion t w ->
  (forall z, In z zones -> shielded k z s v t w from /\
    (lane z = true -> lead_from z < s_in z - t_in z < lead_to z /\
      s (Rmax from from') < s_in z /\ t (Rmax from from') < t_in z /\
      exists y, lane y = true /\ mirrored z y /\ shielded k y t w s v from')) ->
  forall u, Rmax from from' <= u -> ~ occupied (s u) (t u).

(** * Precedence *)

(* A shield at work against one other: how it judges their zone at each call is an argument. *)
Record watches (k : contract) (judges : nat -> Prop) (s v t w : R -> R)
    (tau c : nat -> R) (l : log) (b : nat -> bounds) (since : nat) : Prop := {
  its_calls : on_grid k tau;
  its_ego : obeys k v tau c;
  its_log : true_log k l s v tau c;
  its_other : keeps_contract k w (tau since);
  its_view : forall j, (since <= j)%nat -> known k t w (tau since) (tau j) (b j);
  its_start : (1 <= since)%nat;
  its_judgement : forall i, (since <= i)%nat -> judges i
}.

(* The claim of call i at times tau is newer than that of call j of the other shield, at times tau': before it, the other
   vehicle was at rest, up to r, so long after the first call without its own claim that `go` would have made it faster, and
   again when what was commanded then had taken effect. *)
Definition newer (k : contract) (r : R) (tau : nat -> R) (i : nat) (tau' : nat -> R) (j : nat) (w : R -> R) :=
  exists x x', w x <= r /\ w x' <= r /\ tau' (S j) + switching k + r / ego_go k < x /\ x + switching k <= x' <= tau i.

(* Theorem 4 at crossings: of two shielded vehicles that take each other for one that gives way (D13), neither checking the
   zone itself then, not both are in it, if of each two claims by which it is opened one is newer. P6 is the bound on the rule's braking. C7 is not
   assumed. *)
Definition Theorem4_crossing := forall k r z y s v t w claimed tau c l b since claimed' tau' c' l' b' since',
  valid k -> precedence_braking k <= ego_braking k -> 0 <= r < unheld k ->
  lane z = false -> lane y = false -> mirrored z y -> motion s v -> motion t w ->
  watches k (judged k l c b z claimed since) s v t w tau c l b since ->
  watches k (judged k l' c' b' y claimed' since') t w s v tau' c' l' b' since' ->
  (forall i j, (since <= i)%nat -> opened_at k b z claimed i -> (since' <= j)%nat -> opened_at k b' y claimed' j ->
    newer k r tau i tau' j w \/ newer k r tau' j tau i v) ->
  forall u, Rmax (tau since) (tau' since') <= u -> ~ inside z (s u) (t u).

(* A lane, with a rule of precedence: ego and other arrive at the arc lengths [mine] and [theirs]. *)
Section Lane.
Variables (k : contract) (l : log) (c : nat -> R) (b : nat -> bounds) (z : zone) (claimed : nat -> Prop) (since : nat).
Variables (mine theirs : R).

(* D8: by a plan that enters ahead, an ego that has no precedence and is not in the lane yet enters before the other, however
   hard it accelerates, can arrive. *)
Definition enters_first (i : nat) :=
  enters_at k l c b z i /\
  (claimed i \/ s_in z <= own_least (ego_at l i) \/
   let target := s_in z - own_s (ego_at l i) + 3 * position_error k in
   let clears := fst (clearing k (least (departs_at k l c i)) target) in
   0 <= clears_before k (theirs - t_most (b i)) (rush k (w_most (b i)) clears)).

(* D12. *)
Definition verified_in_lane (i : nat) :=
  stops k (departs_at k l c i) (goes l i) (stop_limit k z (ego_at l i)) \/
  stops k (departs_at k l c i) (goes l i) (behind k z (ego_at l i) (b i)) \/ enters_first i.

(* D13: a lane is opened once the ego has arrived, if the other can stop half of slack before it. *)
Definition opened_in_lane (i : nat) :=
  claimed i /\ mine <= own_least (ego_at l i) /\
  rest_of {| distance := t_most (b i); speed := w_most (b i) |} (precedence_braking k) <= t_in z - slack k / 2.

Definition judged_in_lane (i : nat) :=
  over l b z i \/ settled k l c b z since i \/ in_force k l c since verified_in_lane i \/ in_force k l c since opened_in_lane i.
End Lane.

(* P7: who is no faster than one that may be taken for one at rest, and brakes at b, stops no later than a follower that keeps
   its distance: one that reacts after ρ and brakes at b̂_f. *)
Definition creeps_behind (k : contract) (r : R) :=
  r * r / (ego_braking k + ego_braking k)
  <= r * follower_reaction k + r * r / (follower_braking k + follower_braking k) + slack k.

(* Two shielded vehicles with a rule of precedence, which watch each other since before either was in the lane, never are in it
   together. None of C6, C7 and A9 is assumed. P7 and how lanes are judged are arguments, so that Ahead.v can leave something
   out. *)
Definition Lane_guarantee (creeps : contract -> R -> Prop)
    (judges : contract -> log -> (nat -> R) -> (nat -> bounds) -> zone -> (nat -> Prop) -> nat -> R -> R -> nat -> Prop) :=
  forall k r z y s v t w mine theirs claimed tau c l b since claimed' tau' c' l' b' since',
  valid k -> precedence_braking k <= ego_braking k -> 0 <= r < unheld k -> creeps k r ->
  lane z = true -> lane y = true -> mirrored z y -> lead_from z < s_in z - t_in z < lead_to z ->
  motion s v -> motion t w ->
  watches k (judges k l c b z claimed since mine theirs) s v t w tau c l b since ->
  watches k (judges k l' c' b' y claimed' since' theirs mine) t w s v tau' c' l' b' since' ->
  (forall i j, claimed i -> claimed' j -> newer k r tau i tau' j w \/ newer k r tau' j tau i v) ->
  s (Rmax (tau since) (tau' since')) < s_in z -> t (Rmax (tau since) (tau' since')) < t_in z ->
  forall u, Rmax (tau since) (tau' since') <= u -> ~ inside z (s u) (t u).

(* Theorem 4 in lanes. *)
Definition Theorem4_lane := Lane_guarantee creeps_behind judged_in_lane.

(* Theorem 4: two shielded vehicles with a rule of precedence, each of whose zones is one of the two kinds, keep apart. *)
Definition Theorem4 := forall k r zones occupied s v t w mine theirs tau c l b since tau' c' l' b' since',
  valid k -> precedence_braking k <= ego_braking k -> 0 <= r < unheld k -> creeps_behind k r ->
  cover zones occupied -> motion s v -> motion t w ->
  (forall z, In z zones -> exists y claimed claimed', lane y = lane z /\ mirrored z y /\
    if lane z then
      lead_from z < s_in z - t_in z < lead_to z /\
      s (Rmax (tau since) (tau' since')) < s_in z /\ t (Rmax (tau since) (tau' since')) < t_in z /\
      watches k (judged_in_lane k l c b z claimed since mine theirs) s v t w tau c l b since /\
      watches k (judged_in_lane k l' c' b' y claimed' since' theirs mine) t w s v tau' c' l' b' since' /\
      forall i j, claimed i -> claimed' j -> newer k r tau i tau' j w \/ newer k r tau' j tau i v
    else
      watches k (judged k l c b z claimed since) s v t w tau c l b since /\
      watches k (judged k l' c' b' y claimed' since') t w s v tau' c' l' b' since' /\
      forall i j, (since <= i)%nat -> opened_at k b z claimed i -> (since' <= j)%nat -> opened_at k b' y claimed' j ->
        newer k r tau i tau' j w \/ newer k r tau' j tau i v) ->
  forall u, Rmax (tau since) (tau' since') <= u -> ~ occupied (s u) (t u).
