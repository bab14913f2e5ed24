(* D12: the plan that is chosen is verified against every hazard, and so is what is left of a plan that is kept. *)
Require Import Reals Lra Lia Psatz List.
Require Import Contract Shipped Motion Reach Statement Ego Plan.
Open Scope R_scope.

(* D8 as the code has it. *)
Inductive passage :=
  | Before (away w : R)     (* before the other arrives at its zone *)
  | Ahead (gap w : R)       (* ahead of the other, into a lane *)
  | Never.

(* hazard.rs: distances from where the ego seems to be. [rests_at] is no farther than [limit]. *)
Record hazard := { target : R; limit : R; rests_at : R; way : passage }.

(* The hazard of a zone: D7, D8. *)
Definition hazard_of (k : contract) (z : zone) (o : own) (b : bounds) (h : hazard) :=
  rests_at h <= limit h /\
  if lane z then
    (limit h = behind k z o b /\ way h = Never) \/
    (limit h = stop_limit k z o /\ target h = s_in z - own_s o + 3 * position_error k /\
     way h = Ahead (gap_ahead z o b) (w_most b))
  else limit h = stop_limit k z o /\ target h = s_out z - own_s o + 3 * position_error k /\
     way h = Before (t_in z - t_most b) (w_most b).

(* passage_margin of verified.rs; FAR stands for more than any distance. *)
Definition passage_margin (k : contract) (far : R) (h : hazard) (clears v : R) :=
  match way h with
  | Before away w => clears_before k away (rush k w clears)
  | Ahead gap w => enters_ahead k gap (rush k w clears) (safe_gap k (speed (rush k w clears)) v)
  | Never => - far
  end.

Section Choice.
Variables (k : contract) (d : departs) (far : R).
Hypothesis ok : valid k.
Hypothesis far_pos : 0 < far.

Definition clears (h : hazard) := fst (clearing k (least d) (target h)).
Definition passage_of (h : hazard) := passage_margin k far h (clears h) (snd (clearing k (least d) (target h))).

(* The hazard is passed in time by a plan of n periods of go, or the ego rests before it. *)
Definition met (n : nat) (h : hazard) :=
  stops k d n (limit h) \/ (clears h <= shortest_period k + INR n * period k /\ 0 <= passage_of h).

(* A hazard that is met is a zone against which the plan is verified. *)
Lemma met_is_verified z o b h n : hazard_of k z o b h -> met n h -> verified k z o b d n.
Proof.
  unfold hazard_of, met, verified, passage_of, passage_margin, clears. intros [_ what] m.
  destruct (lane z).
  - destruct what as [(el & ew) | (el & et & ew)]; rewrite ew, ?el in m.
    + destruct m as [st | [_ neg]]; [right; left; exact st | lra].
    + destruct m as [st | [it pass]]; [left; exact st |]. right; right. unfold enters, in_time. rewrite et in it, pass.
      destruct (clearing k (least d) _). split; assumption.
  - destruct what as (el & et & ew). rewrite ew, el in m.
    destruct m as [st | [it pass]]; [left; exact st |]. right. unfold Statement.passes, in_time. rewrite et in it, pass.
    split; assumption.
Qed.

(** * The search for a plan *)

(* The candidate that goes until hazards up to [last] are passed and rests before the others: its margin, as [best] computes
   it. [beyond] is the least place of rest of the others. *)
Definition candidate_margin (passed : list hazard) (last : hazard) (n : nat) (beyond : R) :=
  Rmin (fold_right Rmin (passage_of last) (map passage_of passed))
    (stops_short k beyond (rest k (most d) (INR n * period k))).

Lemma below_fold x y l : x <= fold_right Rmin y l -> x <= y /\ forall z, In z l -> x <= z.
Proof.
  induction l as [| a l IH]; cbn; intros le; [split; [exact le | intros _ []] |].
  pose proof (Rmin_l a (fold_right Rmin y l)). pose proof (Rmin_r a (fold_right Rmin y l)).
  destruct IH as [A B]; [lra |]. split; [exact A |]. intros z [<- | zin]; [lra | apply B, zin].
Qed.

(* A farther target is reached later. *)
Lemma clearing_grows r x y : 0 <= speed r -> x <= y -> fst (clearing k r x) <= fst (clearing k r y).
Proof.
  intros r0 xy. rewrite !clearing_is. cbn [fst]. apply Rplus_le_compat_r, Rplus_le_compat_r.
  unfold until. cbn [fst].
  assert (g0 : 0 < ego_go k) by (destruct ok; lra).
  set (C := Rmax (unlimited k) (speed r)).
  assert (C0 : 0 < C).
  { apply Rlt_le_trans with (unlimited k); [| apply Rmax_l]. rewrite unlimited_is.
    apply Rlt_le_trans with (2 := Rmax_r _ _). lra. }
  set (lim := (C - speed r) * (C + speed r) / (ego_go k + ego_go k)).
  assert (left : Rmax (x - distance r) 0 <= Rmax (y - distance r) 0) by (apply Rle_max_compat_r; lra).
  apply Rplus_le_compat.
  - apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; lra |]. apply Rle_max_compat_r.
    apply Rplus_le_compat_r. apply sqrt_le_1_alt. apply Rplus_le_compat_l, Rmult_le_compat_l; [lra |].
    apply Rle_min_compat_r, left.
  - apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; lra |]. apply Rle_max_compat_r. lra.
Qed.

Hypothesis least_speed : 0 <= speed (least d).
(* The place of rest of a plan that brakes at once is no farther than that of one that would go. *)
Hypothesis brakes_first : rest_of (braking d) (ego_braking k) <= rest k (most d) 0.

Lemma rests_below n : rests k d n <= rest k (most d) (INR n * period k).
Proof. destruct n; [simpl INR; rewrite Rmult_0_l; exact brakes_first | apply Rle_refl]. Qed.

Lemma stops_before n lim beyond :
  beyond <= lim -> 0 <= stops_short k beyond (rest k (most d) (INR n * period k)) -> stops k d n lim.
Proof. intros le st. pose proof (rests_below n). unfold stops, stops_short in *. lra. Qed.

(* The plan that [best] returns, if its margin is not negative, meets every hazard: those that are sorted up to [last] are
   passed, the others come after it. [n] is what [periods] gives. *)
Theorem chosen_meets_all passed last others n beyond :
  (forall h, In h passed -> target h <= target last) ->
  (forall h, In h others -> beyond <= rests_at h /\ rests_at h <= limit h) ->
  clears last <= shortest_period k + INR n * period k ->
  0 <= candidate_margin passed last n beyond ->
  forall h, In h (passed ++ last :: others) -> met n h.
Proof.
  intros sorted far_ones periods_ margin h hin. unfold candidate_margin in margin.
  pose proof (Rmin_l (fold_right Rmin (passage_of last) (map passage_of passed))
    (stops_short k beyond (rest k (most d) (INR n * period k)))) as L.
  pose proof (Rmin_r (fold_right Rmin (passage_of last) (map passage_of passed))
    (stops_short k beyond (rest k (most d) (INR n * period k)))) as R.
  destruct (below_fold 0 (passage_of last) (map passage_of passed) ltac:(lra)) as [P1 P2].
  apply in_app_or in hin. destruct hin as [hin | [<- | hin]].
  - right. split; [| apply P2, in_map, hin].
    apply Rle_trans with (2 := periods_). apply clearing_grows; auto.
  - right. split; assumption.
  - left. destruct (far_ones h hin). apply stops_before with beyond; lra.
Qed.

(* The plan that brakes at once. *)
Theorem braking_meets_all hazards beyond :
  (forall h, In h hazards -> beyond <= rests_at h /\ rests_at h <= limit h) ->
  0 <= stops_short k beyond (rest_of (braking d) (ego_braking k)) ->
  forall h, In h hazards -> met 0 h.
Proof.
  intros near st h hin. left. destruct (near h hin). unfold stops, stops_short, rests in *. lra.
Qed.

(* What [spare] computes of one hazard: the larger of both margins if it is passed in time, else that of the rest. *)
Definition spare_of (n : nat) (h : hazard) :=
  if Rle_dec (clears h) (shortest_period k + INR n * period k)
  then Rmax (stops_short k (limit h) (rests k d n)) (passage_of h)
  else stops_short k (limit h) (rests k d n).

(* The rest of a plan that is kept meets every suspect hazard. *)
Theorem spare_meets n h : 0 <= spare_of n h -> met n h.
Proof.
  unfold spare_of, met, stops. destruct (Rle_dec _ _) as [it | _]; [| auto].
  destruct (Rmax_spec (stops_short k (limit h) (rests k d n)) (passage_of h)) as [[? ->] | [? ->]]; auto.
Qed.
End Choice.

(* Both assumptions hold of a departure. *)
Lemma departure_least_speed k sensed pl pm a : 0 <= speed (least (departure k sensed pl pm a)).
Proof. rewrite departure_is. apply at_least_speed_nonneg. Qed.

Lemma departure_brakes_first k sensed pl pm a : valid k -> - ego_braking k <= a ->
  rest_of (braking (departure k sensed pl pm a)) (ego_braking k) <= rest k (most (departure k sensed pl pm a)) 0.
Proof.
  intros ok ab. rewrite rest_is, departure_is. cbn zeta. cbn [braking most].
  set (r := at_most (at_most (start (sensed + speed_error k)) (Rmax pm a) (switching k)) a
    (shortest_period k - switching k)).
  rewrite at_most_zero by apply at_most_speed_nonneg.
  assert (r0 : 0 <= speed r) by apply at_most_speed_nonneg.
  assert (sw : 0 <= switching k) by (unfold switching; destruct ok; lra).
  assert (b0 : 0 < ego_braking k) by (destruct ok; lra).
  clearbody r. unfold rest_of. cbn.
  assert (a * switching k <= Rmax a (ego_go k) * switching k) by (apply Rmult_le_compat_r; [lra | apply Rmax_l]).
  set (p := Rmax (speed r + a * switching k) 0). set (q := Rmax (speed r + Rmax a (ego_go k) * switching k) 0).
  assert (pq : 0 <= p <= q) by (split; [apply Rmax_r | apply Rle_max_compat_r; lra]).
  assert ((speed r + p) * switching k <= (speed r + q) * switching k) by (apply Rmult_le_compat_r; lra).
  assert (p * p / (ego_braking k + ego_braking k) <= q * q / (ego_braking k + ego_braking k)).
  { apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; lra | nra]. }
  lra.
Qed.

(* The chosen plan is verified against the zone of every hazard (D12). *)
Theorem chosen_is_verified k sensed pl pm a far passed last others n beyond z o b h :
  valid k -> 0 < far -> - ego_braking k <= a ->
  let d := departure k sensed pl pm a in
  (forall h, In h passed -> target h <= target last) ->
  (forall h, In h others -> beyond <= rests_at h /\ rests_at h <= limit h) ->
  clears k d last <= shortest_period k + INR n * period k ->
  0 <= candidate_margin k d far passed last n beyond ->
  In h (passed ++ last :: others) -> hazard_of k z o b h -> verified k z o b d n.
Proof.
  intros ok f0 ab d sorted far_ones periods_ margin hin hz.
  apply met_is_verified with (far := far) (h := h); auto.
  apply chosen_meets_all with passed last others beyond; auto;
    [apply departure_least_speed | apply departure_brakes_first; assumption].
Qed.
