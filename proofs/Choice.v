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
  { apply Rlt_le_trans with (unlimited k); [| apply Rmax_l]. rewrite unlimited_is. destruct ok. lra. }
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

(* The search itself: [best] of verified.rs. [passed] is the least margin of the hazards that are passed, [found] the best
   margin so far and the periods of its plan. Hazards are sorted; [periods] counts whole periods; clearing that takes longer
   than [horizon] is not planned. *)
Variables (horizon : R) (periods : R -> nat).
Hypothesis enough_periods : forall time, time <= shortest_period k + INR (periods time) * period k.

Definition least_rest (hs : list hazard) := fold_right Rmin far (map rests_at hs).

Fixpoint search (hs : list hazard) (passed : R) (found : R * nat) : R * nat :=
  match hs with
  | nil => found
  | h :: beyond =>
      let passed' := Rmin passed (passage_of h) in
      if Rle_dec passed' (fst found) then found
      else if Rlt_dec horizon (clears h) then found
      else
        let n := periods (clears h) in
        let margin := Rmin passed' (stops_short k (least_rest beyond) (rest k (most d) (INR n * period k))) in
        search beyond passed' (if Rlt_dec (fst found) margin then (margin, n) else found)
  end.

Definition best (hs : list hazard) : R * nat :=
  search hs far (stops_short k (least_rest hs) (rest_of (braking d) (ego_braking k)), O).

Lemma least_rest_below hs h : In h hs -> least_rest hs <= rests_at h.
Proof. intros hin. apply (below_fold (least_rest hs) far (map rests_at hs) (Rle_refl _)), in_map, hin. Qed.

Fixpoint sorted (hs : list hazard) :=
  match hs with nil => True | h :: beyond => (forall g, In g beyond -> target h <= target g) /\ sorted beyond end.

Lemma search_meets_all hs : forall before passed found,
  (forall h, In h (before ++ hs) -> rests_at h <= limit h) ->
  sorted hs -> (forall g h, In g before -> In h hs -> target g <= target h) ->
  (forall h, In h before -> passed <= passage_of h) ->
  (0 <= fst found -> forall h, In h (before ++ hs) -> met (snd found) h) ->
  0 <= fst (search hs passed found) -> forall h, In h (before ++ hs) -> met (snd (search hs passed found)) h.
Proof.
  induction hs as [| h beyond IH]; intros before passed found near order between least_passed good; [exact good |].
  destruct order as [first order]. cbn [search].
  set (passed' := Rmin passed (passage_of h)).
  destruct (Rle_dec passed' (fst found)) as [_ | better]; [exact good |].
  destruct (Rlt_dec horizon (clears h)) as [_ | soon]; [exact good |].
  set (n := periods (clears h)).
  set (margin := Rmin passed' (stops_short k (least_rest beyond) (rest k (most d) (INR n * period k)))).
  assert (same : before ++ h :: beyond = (before ++ h :: nil) ++ beyond) by (rewrite <- app_assoc; reflexivity).
  rewrite same in *.
  assert (P1 : passed' <= passed) by apply Rmin_l. assert (P2 : passed' <= passage_of h) by apply Rmin_r.
  assert (up_to : forall g, In g (before ++ h :: nil) -> passed' <= passage_of g /\ target g <= target h).
  { intros g hin. apply in_app_or in hin. destruct hin as [hin | [<- | []]]; [| split; [exact P2 | apply Rle_refl]].
    split; [specialize (least_passed g hin); lra | apply between; [exact hin | left; reflexivity]]. }
  apply IH; auto.
  - intros g f hin fin. apply in_app_or in hin. destruct hin as [hin | [<- | []]]; [| apply first, fin].
    apply between; [exact hin | right; exact fin].
  - intros g hin. apply up_to, hin.
  - destruct (Rlt_dec (fst found) margin) as [_ | _]; [| exact good]. cbn [fst snd]. intros pos g hin.
    assert (M1 : margin <= passed') by apply Rmin_l.
    assert (M2 : margin <= stops_short k (least_rest beyond) (rest k (most d) (INR n * period k))) by apply Rmin_r.
    specialize (near g hin). apply in_app_or in hin. destruct hin as [hin | hin].
    + right. destruct (up_to g hin). split; [| lra].
      apply Rle_trans with (clears h); [apply clearing_grows; assumption | apply enough_periods].
    + left. pose proof (least_rest_below beyond g hin). apply stops_before with (least_rest beyond); lra.
Qed.

(* The plan that [best] finds meets every hazard, if its margin is not negative. *)
Theorem best_meets_all hs :
  sorted hs -> (forall h, In h hs -> rests_at h <= limit h) ->
  0 <= fst (best hs) -> forall h, In h hs -> met (snd (best hs)) h.
Proof.
  intros order near. unfold best. apply (search_meets_all hs nil); auto; [intros _ _ [] | intros _ [] |].
  cbn [fst snd]. intros st h hin. left. pose proof (least_rest_below hs h hin). specialize (near h hin).
  unfold stops, stops_short, rests in *. lra.
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

(* D12: the plan that is chosen is verified against the zone of every hazard. *)
Theorem chosen_is_verified k sensed pl pm a far horizon periods hs z o b h :
  valid k -> 0 < far -> - ego_braking k <= a ->
  (forall time, time <= shortest_period k + INR (periods time) * period k) ->
  let d := departure k sensed pl pm a in
  sorted hs -> (forall h, In h hs -> rests_at h <= limit h) ->
  0 <= fst (best k d far horizon periods hs) ->
  In h hs -> hazard_of k z o b h -> verified k z o b d (snd (best k d far horizon periods hs)).
Proof.
  intros ok f0 ab enough d order near margin hin hz.
  apply met_is_verified with (far := far) (h := h); auto.
  apply best_meets_all; auto; [apply departure_least_speed | apply departure_brakes_first; assumption].
Qed.

(* So is what is left of a plan that is kept against a suspect hazard (D16). *)
Theorem kept_is_verified k d far n z o b h :
  0 < far -> 0 <= spare_of k d far n h -> hazard_of k z o b h -> verified k z o b d n.
Proof. intros f0 sp hz. apply met_is_verified with (far := far) (h := h); auto. apply spare_meets, sp. Qed.
