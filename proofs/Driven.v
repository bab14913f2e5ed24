(* (i) for a drivetrain that is late and not exact, in the words of the functions that fly. *)
Require Import Reals Lra Lia Psatz List.
From Coquelicot Require Import Coquelicot.
Require Import Contract Shipped Motion Reach Lag Drive Departs Clears.
Open Scope R_scope.

Section Driven.
Variables (k : drivetrain) (sensed : R) (late_ : bool) (parts : list part) (a : R).

Let strong := strongest k a.
Let weak := weakest k a.
Let go_most := strongest k (ego_go k).
Let go_least := weakest k (ego_go k).

(* By how much a reduced go may slow the ego. *)
Definition fades := (ego_disturbance k + ego_disturbance k) / (1 - ego_gain k).

(* The accelerations that may act at first. *)
Definition low_first := match parts with nil => 0 | p :: _ => low p end.
Definition standing := hold k (Rmin low_first weak) (Rmax weak go_least).

Let low_leg r (q d : R) := sinking (fading r (unlimited_driven k) (fades * d)) q (unlimited_driven k) d standing.

(* The loop of margin::departure. *)
Definition departure_driven : departs :=
  let left := fold_left (fun x p => x - lasts p) parts (shortest_period k) in
  let b := fold_left (fun r p => at_most r (Rmax (high p) strong) (lasts p)) parts (start (sensed + speed_error k)) in
  let m := fold_left (fun r p => at_most r (highest k a true p) (lasts p)) parts (start (sensed + speed_error k)) in
  let l := fold_left (fun r p => low_leg r (lowest k a p) (lasts p)) parts (start (sensed - speed_error k)) in
  if late_ then {|
    braking := at_most b strong (shortest_period k);
    most := at_most m (Rmax strong go_most) (shortest_period k);
    least := low_leg l (Rmin weak go_least) (shortest_period k) |}
  else {|
    braking := at_most (at_most b strong left) strong (response k);
    most := at_most (at_most m strong left) (Rmax strong go_most) (response k);
    least := low_leg (low_leg l weak left) (Rmin weak go_least) (response k) |}.
End Driven.

(* It is what the code computes, for what is inherited in one part, which the end of the period may divide: of the fastest ego
   here; of the slowest, [low_leg] is what the code does in each leg, and the legs are transcribed. *)
Lemma departure_soon_is k sensed lo hi a :
  let d := departure_driven k sensed false ({| lasts := response k; low := lo; high := hi; later := false |} :: nil) a in
  braking (departure_soon k sensed lo hi a) = braking d /\ most (departure_soon k sensed lo hi a) = most d.
Proof. split; reflexivity. Qed.

Lemma departure_late_is k sensed lo hi a :
  let d := departure_driven k sensed true
    ({| lasts := shortest_period k; low := lo; high := hi; later := false |} ::
     {| lasts := response k - shortest_period k; low := lo; high := hi; later := true |} :: nil) a in
  braking (departure_late k sensed lo hi a) = braking d /\ most (departure_late k sensed lo hi a) = most d.
Proof. split; reflexivity. Qed.

Lemma fold_map {A B C} (f : A -> B -> A) (h : C -> B) l : forall r,
  fold_left f (map h l) r = fold_left (fun r p => f r (h p)) l r.
Proof. induction l as [| p l IH]; intros r; [reflexivity | apply IH]. Qed.

Lemma sinks_is cap floor r q d : sinks cap floor r q d = sinking r q cap d floor.
Proof. reflexivity. Qed.

Lemma faded_is cap r loss : faded cap r loss = fading r cap loss.
Proof. reflexivity. Qed.

(* D11, D14: where the ego is at rest by a plan of n periods. *)
Definition rests_driven (k : drivetrain) (d : departs) (n : nat) :=
  match n with O => rest_of (braking d) (weakest k (ego_braking k)) | S _ => rest_driven k (most d) (INR n * period k) end.

(* The conditions: C4 and C5; a log that is true; a plan that is carried out for [count] calls. *)
Record carried (k : drivetrain) (theta : R) (s v x pull : R -> R) (tau c : nat -> R) (i n count : nat) (sensed : R)
    (parts : list part) (late_ : bool) : Prop := {
  in_range : drivable k /\ 0 < weakest k (ego_go k) /\ 0 < unlimited_driven k;
  goes_forwards : motion s v;
  is_driven : drives k theta v x pull tau c;
  (* A limiter holds the ego at a speed of [unlimited_driven] or above, and never slows it. *)
  is_held : goes_with (fun t => - v t) (fun t => - x t) (fun t => - pull t) (- unlimited_driven k);
  on_time : exists start, forall i,
    start + INR i * period k - jitter k <= tau i <= start + INR i * period k + jitter k;
  is_inherited : inherits k theta x pull tau c i 0 parts;
  is_late : if late_ then shortest_period k <= response k else response k <= shortest_period k;
  is_sensed : sensed - speed_error k <= v (tau (S i)) <= sensed + speed_error k;
  is_planned : - ego_braking k <= c (S i);
  then_goes : forall q, (q < count)%nat -> (q < n)%nat -> c (S (S i) + q)%nat <= ego_go k;
  then_brakes : forall q, (q < count)%nat -> (n <= q)%nat -> c (S (S i) + q)%nat = - ego_braking k
}.

Section Plan.
Variables (k : drivetrain) (theta : R) (s v x pull : R -> R) (tau c : nat -> R) (i n count : nat) (sensed : R)
  (parts : list part) (late_ : bool).
Hypothesis carries : carried k theta s v x pull tau c i n count sensed parts late_.
Let T := tau (S i).
Let E := tau (S (S i) + count)%nat.
Let d := departure_driven k sensed late_ parts (c (S i)).

Lemma left_is o ps : inherits k theta x pull tau c i o ps -> forall y,
  fold_left (fun x p => x - lasts p) ps y = y - (response k - o).
Proof.
  revert o. induction ps as [| p ps IH]; intros o inh y; cbn in *; [lra |].
  destruct inh as (_ & _ & _ & _ & more). rewrite (IH _ more). ring.
Qed.

Lemma rests_is : rests_driven k d n = rest_of (after_legs (legs_up k (c (S i)) n late_ parts) (start (sensed + speed_error k)))
  (weakest k (ego_braking k)).
Proof.
  destruct carries as [_ _ _ _ _ inh _ _ _ _ _]. pose proof (left_is 0 parts inh (shortest_period k)) as left.
  rewrite Rminus_0_r in left.
  unfold rests_driven, d, departure_driven, after_legs, legs_up. rewrite !fold_left_app, fold_map, left.
  assert (none : forall r q y, 0 <= speed r -> y = 0 -> at_most r q y = r).
  { intros [p w] q y w0 ->. unfold at_most. cbn in *. f_equal; [ring | rewrite Rmax_left; lra]. }
  assert (pos : forall r q y, 0 <= speed (at_most r q y)) by (intros; apply Rmax_r).
  destruct n as [| n'].
  - assert (plain : forall l r, fold_left (fun r p => at_most r (highest k (c (S i)) false p) (lasts p)) l r =
                                fold_left (fun r p => at_most r (Rmax (high p) (strongest k (c (S i)))) (lasts p)) l r).
    { induction l as [| p l IH]; intros r; [reflexivity |]. cbn [fold_left]. rewrite IH. unfold highest.
      rewrite Bool.andb_false_r. reflexivity. }
    cbn [fst snd]. rewrite plain. simpl INR. rewrite Rmult_0_l.
    destruct late_; cbn [fold_left fst snd braking]; (rewrite (none _ (strongest k (ego_go k)) 0); [reflexivity | apply pos | reflexivity]).
  - destruct late_; cbn [fold_left fst snd most]; unfold rest_driven; reflexivity.
Qed.

(* From any moment on, the ego would, if it braked, be at rest by the place that was verified. *)
Theorem plan_of_a_drivetrain_stops u : T <= u <= E ->
  s u - s T + v u * v u / (weakest k (ego_braking k) + weakest k (ego_braking k)) <= rests_driven k d n.
Proof.
  intros h. rewrite rests_is. destruct carries as [(dr & _) m drive _ grid inh late_ok sen pl go br].
  apply (stops_where_planned k theta s v x pull tau c m drive grid dr i n count (c (S i)) sensed parts late_); auto. apply sen.
Qed.

(* By the clearing time it has gone the target, and on the way it can become no faster than computed in the time that is left: if
   the slowest ego does not come to a stand before it goes, and go is not reduced. *)
Theorem plan_of_a_drivetrain_clears target most_ :
  Departs.goes_on (unlimited_driven k) (fades k) (standing k parts (c (S i))) (start (sensed - speed_error k))
    (legs_down k (c (S i)) late_ parts) ->
  (forall q, (q < count)%nat -> (q < n)%nat -> c (S (S i) + q)%nat = ego_go k) ->
  weakest k (c (S i)) <= most_ -> weakest k (ego_go k) <= most_ -> 0 <= most_ ->
  fst (clearing_driven k (least d) target) <= shortest_period k + INR n * period k ->
  let clears := fst (clearing_driven k (least d) target) in
  let fast := snd (clearing_driven k (least d) target) in
  (T + clears <= E -> target <= s (T + clears) - s T) /\
  forall u, T <= u <= E -> u <= T + clears ->
    fast <= v u + most_ * (T + clears - u) /\ fast <= Rmax (unlimited_driven k) (v u).
Proof.
  intros on_the_way unreduced am gm m0. destruct carries as [(dr & g0 & cap0) m drive held grid inh late_ok sen pl go br].
  set (cap := unlimited_driven k) in *. set (fade := fades k) in *. set (floor := standing k parts (c (S i))) in *.
  assert (fade0 : 0 <= fade).
  { destruct dr as (_ & _ & _ & _ & _ & gain & dist & _). unfold fade, fades.
    apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; lra]. }
  assert (floor0 : floor <= 0).
  { unfold floor, standing, hold. set (p := Rmax 0 _). assert (0 <= p) by apply Rmax_l.
    assert (0 <= ego_lag k) by (destruct dr as (_ & _ & _ & _ & l & _); exact l).
    assert (0 <= ego_lag k * p / sqrt (1 + p / Rmax (weakest k (c (S i))) (weakest k (ego_go k)))).
    { set (y := sqrt _). destruct (Req_dec y 0) as [z | nz].
      - unfold Rdiv. rewrite z, Rinv_0. lra.
      - apply Rmult_le_pos; [apply Rmult_le_pos; lra | left; apply Rinv_0_lt_compat].
        pose proof (sqrt_pos (1 + p / Rmax (weakest k (c (S i))) (weakest k (ego_go k)))). fold y in H1. lra. }
    lra. }
  assert (L : least d = after_low cap fade floor (legs_down k (c (S i)) late_ parts) (start (sensed - speed_error k))).
  { pose proof (left_is 0 parts inh (shortest_period k)) as left. rewrite Rminus_0_r in left.
    unfold d, departure_driven, after_low, legs_down. rewrite fold_left_app, fold_map, left.
    destruct late_; reflexivity. }
  assert (r30 : 0 <= speed (least d)) by (rewrite L; apply (goes_on_end cap fade floor); exact on_the_way).
  assert (C : clearing_driven k (least d) target =
    (fst (goes_until k cap fade (least d) target) + shortest_period k + response k, snd (goes_until k cap fade (least d) target))).
  { set (f := fading (least d) cap (fade * (Rmax (target - distance (least d)) 0 / cap))).
    assert (f0 : 0 <= speed f).
    { unfold f, fading. cbn [speed]. apply Rmin_glb; [exact r30 |]. apply Rle_trans with (2 := Rmax_l _ _). lra. }
    assert (F : {| distance := distance f; speed := Rmax (speed f) 0 |} = f).
    { rewrite Rmax_left by exact f0. destruct f; reflexivity. }
    assert (G : goes_until k cap fade (least d) target = until f target (weakest k (ego_go k)) cap) by reflexivity.
    assert (P : clearing_driven k (least d) target =
      (Rmax 0 (Ropp (speed f)) / weakest k (ego_go k)
         + fst (until {| distance := distance f; speed := Rmax (speed f) 0 |} target (weakest k (ego_go k)) cap)
         + shortest_period k + response k,
       snd (until {| distance := distance f; speed := Rmax (speed f) 0 |} target (weakest k (ego_go k)) cap))) by reflexivity.
    rewrite P, F, G, (Rmax_left 0 (- speed f)) by lra. f_equal. unfold Rdiv. ring. }
  rewrite C. cbn [fst snd]. rewrite L. intros it.
  apply (clears_where_planned k cap fade floor cap0 fade0 floor0 theta s v x pull tau c m drive held grid dr g0 i n count (c (S i))
    sensed target most_ parts late_ inh late_ok eq_refl unreduced (conj am (conj gm m0)) on_the_way); [lra | exact it].
Qed.
End Plan.

(* The lag must be counted: of a speed that still rises after what is followed has ended, no bound that does not is one. *)
Lemma lag_must_be_counted : exists theta v x pull bound,
  lags theta x pull /\ goes_with v x pull 0 /\ (forall u, 0 <= u -> Rmin 0 (bound 0) <= bound u) /\
  pieces theta 0 0 x pull bound 0 1 /\ v 0 <= bound 0 /\ bound 1 < v 1.
Proof.
  exists 1, (fun t => 1 - exp (- t)), (fun t => 1 - exp (- t)), (fun _ => 1), (fun _ => 0).
  split; [| split; [| split; [| split; [| split]]]].
  - constructor; [lra | lra |]. intros _ t. auto_derive; [trivial | field].
  - intros t t' _. left. lra.
  - intros u _. apply Rmin_l.
  - apply one_more with (q := 0) (t2 := 1); [| apply no_piece; lra]. constructor; [lra | intros; lra | intros; lra |].
    intros t t' _ _ _. lra.
  - rewrite Ropp_0, exp_0. lra.
  - pose proof (exp_increasing (- (1)) 0 ltac:(lra)) as X. rewrite exp_0 in X. lra.
Qed.
