(* (i) for such a drivetrain: by when the slowest ego has gone as far as planned, as long as it does not come to a stand. *)
Require Import Reals Lra Lia Psatz List.
From Coquelicot Require Import Coquelicot.
Require Import Contract Shipped Motion Reach Lag Drive.
Open Scope R_scope.

Section Departs.
Variables (k : drivetrain) (cap fade floor : R).

(* As fast as that after it has lost [loss], but not below the cap; and then as far as that, counted down to the floor. *)
Definition faded (r : reach) (loss : R) : reach :=
  {| distance := distance r; speed := Rmin (speed r) (Rmax cap (speed r - loss)) |}.
Definition sinks (r : reach) (q d : R) : reach :=
  let w := Rmin (speed r + q * d) (Rmax cap (speed r)) in
  {| distance := distance r + Rmax ((speed r + w) * d * (1 / 2)) 0; speed := Rmax w floor |}.
Definition slower (r : reach) (leg : R * R) := sinks (faded r (fade * fst leg)) (snd leg) (fst leg).

Hypothesis fade0 : 0 <= fade.
Hypothesis floor0 : floor <= 0.
Hypothesis cap0 : 0 < cap.

Definition in_leg (r : reach) (d q u : R) :=
  let f := speed (faded r (fade * d)) in Rmin (f + q * u) (Rmax cap f).

Fixpoint low_at (r : reach) (legs : list (R * R)) (u : R) :=
  match legs with
  | nil => speed r
  | (d, q) :: rest => if Rle_dec u d then in_leg r d q u else low_at (slower r (d, q)) rest (u - d)
  end.

(* The ego goes on: in no leg does the bound come below 0. *)
Fixpoint goes_on (r : reach) (legs : list (R * R)) : Prop :=
  match legs with
  | nil => 0 <= speed r
  | (d, q) :: rest => 0 <= speed (faded r (fade * d)) /\ 0 <= in_leg r d q d /\ goes_on (slower r (d, q)) rest
  end.

Lemma faded_below r d : 0 <= d -> speed (faded r (fade * d)) <= speed r.
Proof. intros. cbn. apply Rmin_l. Qed.

Lemma slower_speed r d q : 0 <= in_leg r d q d -> speed (slower r (d, q)) = in_leg r d q d.
Proof. intros h. unfold slower, sinks, in_leg in *. cbn [fst snd speed] in *. apply Rmax_left. lra. Qed.

Lemma low_at_first legs r : ordered legs -> low_at r legs 0 <= speed r.
Proof.
  destruct legs as [| [d q] legs]; intros ord; [cbn; lra |]. inversion ord as [| ? ? d0 ?]; subst. cbn [fst] in d0.
  cbn [low_at]. destruct (Rle_dec 0 d); [| lra]. unfold in_leg. pose proof (faded_below r d d0).
  apply Rle_trans with (1 := Rmin_l _ _). lra.
Qed.

(* The bound rises by no more than the acceleration of a leg, and not beyond the cap, or where it began. *)
Lemma in_leg_rises r d q u w : 0 <= u <= w -> in_leg r d q w - in_leg r d q u <= q * (w - u).
Proof.
  intros [u0 le]. unfold in_leg. set (f := speed (faded r (fade * d))). pose proof (Rmax_r cap f). set (C := Rmax cap f) in *.
  assert (Q : q * (w - u) = q * w - q * u) by ring.
  destruct (Rle_dec 0 q).
  - assert (0 <= q * (w - u)) by (apply Rmult_le_pos; lra). cases; lra.
  - assert (q * u <= 0) by nra. assert (q * w <= 0) by nra. cases; lra.
Qed.

Lemma in_leg_below r d q u : in_leg r d q u <= Rmax cap (speed (faded r (fade * d))).
Proof. apply Rmin_r. Qed.

Lemma low_below legs : forall r u, ordered legs -> goes_on r legs -> low_at r legs u <= Rmax cap (low_at r legs 0).
Proof.
  induction legs as [| [d q] legs IH]; intros r u ord go; cbn [low_at]; [apply Rmax_r |].
  inversion ord as [| ? ? d0 ord']; subst. cbn [fst] in d0. destruct go as (_ & e0 & go).
  assert (F : in_leg r d q 0 = speed (faded r (fade * d))).
  { unfold in_leg. rewrite Rmult_0_r, Rplus_0_r. apply Rmin_left, Rmax_r. }
  destruct (Rle_dec 0 d); [rewrite F | lra].
  destruct (Rle_dec u d); [apply in_leg_below |].
  apply Rle_trans with (1 := IH _ _ ord' go). apply Rmax_lub; [apply Rmax_l |].
  apply Rle_trans with (1 := low_at_first _ _ ord'). rewrite slower_speed by exact e0. apply in_leg_below.
Qed.

Variables (theta : R) (s v x pull : R -> R) (T E : R).
Hypothesis m : motion s v.
Hypothesis follows_ : lags theta x pull.
Hypothesis constant_ : theta <= ego_lag k.
(* A limiter may hold the ego at the cap or above, and never slows it. *)
Hypothesis held : goes_with (fun t => - v t) (fun t => - x t) (fun t => - pull t) (- cap).

(* One leg, from o after T on: nothing that is followed from the lag before on is less. *)
Definition leg_low (o : R) (leg : R * R) := 0 <= fst leg /\
  (forall t t', T <= t -> T + o - ego_lag k <= t -> t <= t' -> t' <= T + o + fst leg -> t' <= E ->
     snd leg * (t' - t) <= pull t' - pull t) /\
  (o < ego_lag k -> theta * snd leg <= pull T - x T).

Fixpoint legs_low (o : R) (legs : list (R * R)) :=
  match legs with nil => True | leg :: rest => leg_low o leg /\ legs_low (o + fst leg) rest end.

Lemma low_ordered legs : forall o, legs_low o legs -> ordered legs.
Proof. induction legs as [| leg legs IH]; intros o H; constructor; [apply H | apply (IH _ (proj2 H))]. Qed.

Lemma no_slower r legs u : legs_low 0 legs -> goes_on r legs -> speed r <= v T ->
  T <= u <= E -> u <= T + total legs -> low_at r legs (u - T) <= v u.
Proof.
  intros ok go vT [lo hi] within. pose proof (low_ordered legs 0 ok) as ord.
  set (bound := fun w => - low_at r legs (w - T)).
  assert (b0 : bound T = - low_at r legs 0) by (unfold bound; replace (T - T) with 0 by ring; reflexivity).
  assert (chain : forall ls q o, 0 <= o -> legs_low o ls -> goes_on q ls -> o + total ls <= total legs ->
            (forall w, T + o < w <= T + o + total ls -> bound w = - low_at q ls (w - T - o)) ->
            (bound (T + o) <= - low_at q ls 0) ->
            forall e, T + o <= e -> e <= E -> e <= T + o + total ls ->
            pieces theta (ego_lag k) T (fun t => - x t) (fun t => - pull t) bound (T + o) e).
  { induction ls as [| [d q] ls IH]; intros r' o o0 lok go' tot same first_ e e1 e2 e3.
    - cbn in e3. replace e with (T + o) by lra. apply no_piece. lra.
    - destruct lok as [(d0 & fol & had_) more]. cbn [fst snd total] in *. destruct go' as (f0 & end0 & go').
      pose proof (total_nonneg ls (low_ordered _ _ more)).
      assert (same_in : forall w, T + o < w <= T + o + d -> bound w = - in_leg r' d q (w - T - o)).
      { intros w ?. rewrite same by lra. cbn [low_at]. destruct (Rle_dec (w - T - o) d); [reflexivity | lra]. }
      assert (at0 : bound (T + o) <= - in_leg r' d q 0).
      { cbn [low_at] in first_. destruct (Rle_dec 0 d); [exact first_ | lra]. }
      assert (one : forall e', T + o <= e' <= T + o + d -> e' <= E ->
                piece theta (ego_lag k) T (fun t => - x t) (fun t => - pull t) bound (- q) (T + o) e').
      { intros e' [? ?] ?. constructor; [lra | | |].
        - intros t t' ? ? ? ?. pose proof (fol t t' ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra)). lra.
        - intros soon. pose proof (had_ ltac:(lra)). lra.
        - intros t t' ? ? ?.
          destruct (Req_dec t t') as [-> | ne]; [lra |]. rewrite (same_in t') by lra.
          assert (B : bound t <= - in_leg r' d q (t - T - o)).
          { destruct (Req_dec t (T + o)) as [-> | ne2].
            - replace (T + o - T - o) with 0 by ring. exact at0.
            - rewrite (same_in t) by lra. lra. }
          pose proof (in_leg_rises r' d q (t - T - o) (t' - T - o) ltac:(lra)) as G.
          replace (t' - T - o - (t - T - o)) with (t' - t) in G by ring. lra. }
      destruct (Rle_dec e (T + o + d)) as [early | beyond].
      + apply one_more with (q := - q) (t2 := e); [apply one; lra | apply no_piece; lra].
      + apply one_more with (q := - q) (t2 := T + o + d); [apply one; lra |].
        replace (T + o + d) with (T + (o + d)) by ring.
        assert (sp : speed (slower r' (d, q)) = in_leg r' d q d) by (apply slower_speed; exact end0).
        assert (at_d : bound (T + (o + d)) <= - speed (slower r' (d, q))).
        { rewrite sp. destruct (Req_dec d 0) as [z | nz].
          - rewrite z at 1 3. replace (T + (o + 0)) with (T + o) by ring. exact at0.
          - replace (T + (o + d)) with (T + o + d) by ring. rewrite same_in by lra.
            replace (T + o + d - T - o) with d by ring. lra. }
        apply (IH (slower r' (d, q))); auto; try lra.
        * intros w [? ?]. rewrite same by lra. cbn [low_at]. destruct (Rle_dec (w - T - o) d); [lra |].
          replace (w - T - (o + d)) with (w - T - o - d) by ring. reflexivity.
        * pose proof (low_at_first ls (slower r' (d, q)) (low_ordered _ _ more)). lra. }
  assert (K : - v u <= bound u); [| unfold bound in K; lra].
  apply (lag_is_a_delay theta (ego_lag k) (- cap) T (fun t => - v t) (fun t => - x t) (fun t => - pull t) bound) with (E := u);
    auto; try lra.
  - destruct follows_ as [c1 c2 c3]. constructor; [exact c1 | intros z t; rewrite (c2 z t); ring |].
    intros pos t. pose proof (is_derive_opp x t _ (c3 pos t)) as D.
    replace ((- pull t - - x t) / theta) with (opp ((pull t - x t) / theta)); [exact D |]. unfold opp. cbn. field. lra.
  - intros w hw. rewrite b0. unfold bound. pose proof (low_below legs r (w - T) ord go) as L. revert L. cases; lra.
  - replace T with (T + 0) at 2 by ring. apply (chain legs r); auto; try lra.
    + intros w [? ?]. unfold bound. replace (w - T - 0) with (w - T) by ring. reflexivity.
    + replace (T + 0) with T by ring. rewrite b0. lra.
  - rewrite b0. pose proof (low_at_first legs r ord). lra.
Qed.

(** * How far *)

Definition after_low := fold_left slower.

Lemma one_leg_low r d q o u : 0 <= d -> o <= u -> u <= o + d ->
  (forall t, o < t <= u -> in_leg r d q (t - o) <= v t) -> 0 <= speed (faded r (fade * d)) -> 0 <= in_leg r d q (u - o) ->
  speed (faded r (fade * d)) <= v o ->
  (speed (faded r (fade * d)) + in_leg r d q (u - o)) * (u - o) * (1 / 2) <= s u - s o.
Proof.
  intros d0 le ud below f0 e0 first_. set (f := speed (faded r (fade * d))) in *. set (dt := u - o) in *.
  destruct (Req_dec dt 0) as [z | nz].
  { rewrite z. replace u with o by (unfold dt in z; lra). lra. }
  assert (dt > 0) by (unfold dt in *; lra). set (W := in_leg r d q dt) in *.
  destruct (slope f W dt ltac:(lra)) as (p & Q).
  assert (line : forall t, o <= t <= u -> f + p * (t - o) <= v t).
  { intros t [lo hi]. destruct (Req_dec t o) as [-> | ne]; [replace (o - o) with 0 by ring; lra |].
    apply Rle_trans with (2 := below t ltac:(lra)). unfold in_leg. fold f. pose proof (Rmax_r cap f).
    assert (W1 : W <= f + q * dt) by (unfold W, in_leg; fold f; apply Rmin_l).
    assert (W2 : W <= Rmax cap f) by (unfold W, in_leg; fold f; apply Rmin_r).
    assert (p <= q) by nra. assert (p * (t - o) <= q * (t - o)) by nra.
    apply Rmin_glb; [lra |]. destruct (Rle_dec p 0).
    - assert (p * (t - o) <= 0) by nra. lra.
    - assert (p * (t - o) <= p * dt) by (unfold dt; nra). lra. }
  pose proof (above_line s v f p o u m le line) as B. fold dt in B.
  replace (p * dt * dt / 2) with ((W - f) * dt / 2) in B by (rewrite <- Q; field). lra.
Qed.

Lemma in_leg_start r d q : in_leg r d q 0 = speed (faded r (fade * d)).
Proof. unfold in_leg. rewrite Rmult_0_r, Rplus_0_r. apply Rmin_left, Rmax_r. Qed.

Lemma legs_go s0 legs : forall r o, ordered legs -> goes_on r legs ->
  (forall t, o <= t <= o + total legs -> low_at r legs (t - o) <= v t) -> distance r <= s o - s0 ->
  distance (after_low legs r) <= s (o + total legs) - s0 /\ speed (after_low legs r) <= v (o + total legs).
Proof.
  induction legs as [| [d q] legs IH]; intros r o ord go below so.
  - cbn in *. rewrite Rplus_0_r. pose proof (below o ltac:(lra)). lra.
  - inversion ord as [| ? ? d0 ord']; subst. cbn [fst total] in *. destruct go as (f0 & e0 & go).
    pose proof (total_nonneg legs ord').
    change (after_low ((d, q) :: legs) r) with (after_low legs (slower r (d, q))).
    replace (o + (d + total legs)) with (o + d + total legs) by ring.
    assert (inside : forall t, o <= t <= o + d -> in_leg r d q (t - o) <= v t).
    { intros t [? ?]. pose proof (below t ltac:(lra)) as B. cbn [low_at] in B. destruct (Rle_dec (t - o) d); [exact B | lra]. }
    apply IH; auto.
    + intros t [? ?]. destruct (Req_dec t (o + d)) as [-> | ne].
      * replace (o + d - (o + d)) with 0 by ring. apply Rle_trans with (1 := low_at_first legs _ ord').
        rewrite slower_speed by exact e0. replace d with (o + d - o) at 2 by ring. apply inside. lra.
      * pose proof (below t ltac:(lra)) as B. cbn [low_at] in B. destruct (Rle_dec (t - o) d); [lra |].
        replace (t - (o + d)) with (t - o - d) by ring. exact B.
    + pose proof (one_leg_low r d q o (o + d) d0 ltac:(lra) ltac:(lra)) as L.
      replace (o + d - o) with d in L by ring.
      specialize (L ltac:(intros; apply inside; lra) f0 e0).
      specialize (L ltac:(pose proof (inside o ltac:(lra)) as I; replace (o - o) with 0 in I by ring;
                          rewrite in_leg_start in I; exact I)).
      change (distance (slower r (d, q)))
        with (distance r + Rmax ((speed (faded r (fade * d)) + in_leg r d q d) * d * (1 / 2)) 0).
      assert (0 <= (speed (faded r (fade * d)) + in_leg r d q d) * d * (1 / 2)).
      { apply Rmult_le_pos; [apply Rmult_le_pos; lra | lra]. }
      rewrite Rmax_left; [lra | assumption].
Qed.

(* The bound grows no faster than the hardest leg, and not beyond the cap, or what it was. *)
Lemma low_grows A legs : 0 <= A -> forall r, ordered legs -> goes_on r legs -> List.Forall (fun leg : R * R => snd leg <= A) legs ->
  forall u w, 0 <= u <= w -> w <= total legs ->
  low_at r legs w <= low_at r legs u + A * (w - u) /\ low_at r legs w <= Rmax cap (low_at r legs u).
Proof.
  intros A0. induction legs as [| [d q] legs IH]; intros r ord go hard u w [u0 uw] wt.
  - cbn. assert (0 <= A * (w - u)) by (apply Rmult_le_pos; lra). split; [lra | apply Rmax_r].
  - inversion ord as [| ? ? d0 ord']; subst. inversion hard as [| ? ? qA hard']; subst. cbn [fst snd total] in *.
    destruct go as (f0 & e0 & go). pose proof (total_nonneg legs ord').
    assert (leg : forall u w, 0 <= u <= w -> in_leg r d q w <= in_leg r d q u + A * (w - u) /\
                    in_leg r d q w <= Rmax cap (in_leg r d q u)).
    { intros a b [a0 ab]. pose proof (in_leg_rises r d q a b (conj a0 ab)) as R.
      assert (q * (b - a) <= A * (b - a)) by (apply Rmult_le_compat_r; lra). split; [lra |].
      unfold in_leg. set (f := speed (faded r (fade * d))). pose proof (Rmax_r cap f). pose proof (Rmax_l cap f).
      destruct (Rle_dec 0 q).
      - assert (0 <= q * a) by (apply Rmult_le_pos; lra). apply Rle_trans with (1 := Rmin_r _ _).
        apply Rmax_lub; [apply Rmax_l |]. apply Rle_trans with (2 := Rmax_r _ _). apply Rmin_glb; lra.
      - assert (q * b <= q * a) by nra. apply Rle_trans with (2 := Rmax_r _ _). apply Rle_min_compat_r. lra. }
    cbn [low_at]. destruct (Rle_dec u d), (Rle_dec w d); try lra.
    + apply leg; lra.
    + destruct (leg u d ltac:(lra)) as [g1 g2].
      destruct (IH (slower r (d, q)) ord' go hard' 0 (w - d) ltac:(lra) ltac:(lra)) as [i1 i2].
      pose proof (low_at_first legs (slower r (d, q)) ord') as L. rewrite slower_speed in L by exact e0.
      split; [replace (A * (w - u)) with (A * (w - d - 0) + A * (d - u)) by ring; lra |].
      apply Rle_trans with (1 := i2). apply Rmax_lub; [apply Rmax_l |]. lra.
    + replace (w - u) with (w - d - (u - d)) by ring. apply IH; auto; lra.
Qed.
End Departs.
